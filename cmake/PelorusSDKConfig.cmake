# find_package(PelorusSDK) gives the target PelorusSDK::sdk and the functions pelorus_add_plugin() and
# pelorus_add_conformance(). All paths are relative to this file: the folder can be moved.
include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)
include("${CMAKE_CURRENT_LIST_DIR}/PelorusSDKTargets.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/PelorusAddPlugin.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/PelorusAddConformance.cmake")
get_filename_component(PELORUS_CONFORM "${CMAKE_CURRENT_LIST_DIR}/../../../bin/pelorus-conform" ABSOLUTE)
