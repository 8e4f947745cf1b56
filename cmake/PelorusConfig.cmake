# find_package(Pelorus) gives the target Pelorus::pelorus: libpelorus.so and the headers <pelorus/embed.h> (C11) and
# <pelorus/embed.hpp> (C++17). They need the plugin ABI's headers, which lie beside them, and nothing else.
# find_package(Pelorus COMPONENTS sdk) gives PelorusSDK::sdk as well, for plugins of one's own; that needs Eigen.
# All paths are relative to this file: the installation can be moved.
include(CMakeFindDependencyMacro)
get_filename_component(_pelorus_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

if(NOT TARGET Pelorus::pelorus)
    add_library(Pelorus::pelorus SHARED IMPORTED)
    set_target_properties(Pelorus::pelorus PROPERTIES
        IMPORTED_LOCATION "${_pelorus_prefix}/lib/libpelorus.so"
        IMPORTED_SONAME "libpelorus.so"
        INTERFACE_INCLUDE_DIRECTORIES "${_pelorus_prefix}/include"
        INTERFACE_COMPILE_FEATURES "c_std_11;cxx_std_17")
    if(NOT EXISTS "${_pelorus_prefix}/lib/libpelorus.so" OR NOT EXISTS "${_pelorus_prefix}/include/pelorus/abi/abi.h")
        set(Pelorus_FOUND FALSE)
        set(Pelorus_NOT_FOUND_MESSAGE "the installation in ${_pelorus_prefix} is incomplete: it needs the components host and sdk")
    endif()
endif()

foreach(_pelorus_component IN LISTS Pelorus_FIND_COMPONENTS)
    if(_pelorus_component STREQUAL "sdk")
        find_dependency(PelorusSDK "${Pelorus_VERSION}" EXACT PATHS "${_pelorus_prefix}" NO_DEFAULT_PATH)
    elseif(Pelorus_FIND_REQUIRED_${_pelorus_component})
        set(Pelorus_FOUND FALSE)
        set(Pelorus_NOT_FOUND_MESSAGE "there is no component ${_pelorus_component}; there is sdk")
    endif()
endforeach()
unset(_pelorus_component)
unset(_pelorus_prefix)
