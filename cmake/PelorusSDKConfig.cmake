# find_package(PelorusSDK) gives the target PelorusSDK::sdk and the function pelorus_add_plugin().
# All paths are relative to this file: the folder can be moved.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)
include("${CMAKE_CURRENT_LIST_DIR}/PelorusSDKTargets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/PelorusAddPlugin.cmake")
