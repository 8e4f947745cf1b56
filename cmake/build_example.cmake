# cmake -DSETTINGS=FILE -DSOURCE=FOLDER -DSTAMP=FILE -P build_example.cmake
# Configures and builds one example; see PelorusExamples.cmake. One whose compiler is not there is left out, and says so.
cmake_minimum_required(VERSION 3.25)
include("${SETTINGS}")
get_filename_component(name "${SOURCE}" NAME)
set(build "${BUILDS}/${name}")

macro(leave_out needed)
    message(STATUS "The example ${name} is left out: it needs ${needed} (tools/setup examples)")
    return()
endmacro()

file(STRINGS "${SOURCE}/CMakeLists.txt" project_line REGEX "^project\\(")
if(project_line MATCHES "Fortran")
    find_program(fortran gfortran)
    if(NOT fortran)
        leave_out("gfortran")
    endif()
endif()

set(arguments "")
if(EXISTS "${SOURCE}/toolchain.cmake")
    include("${SOURCE}/toolchain.cmake")
    file(WRITE "${BUILDS}/${name}.probe.cpp" "#include <vector>\nint main() { return static_cast<int>(std::vector<int>().size()); }\n")
    execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${CMAKE_CXX_FLAGS_INIT} "${BUILDS}/${name}.probe.cpp" -o "${BUILDS}/${name}.probe"
                    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
    if(failed)
        leave_out("${CMAKE_CXX_COMPILER} ${CMAKE_CXX_FLAGS_INIT}")
    endif()
    list(APPEND arguments --toolchain "${SOURCE}/toolchain.cmake")
endif()

function(quietly)
    execute_process(COMMAND ${ARGV} RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(failed)
        message(FATAL_ERROR "The example ${name} cannot be built:\n${output}")
    endif()
endfunction()

if("${SETTINGS}" IS_NEWER_THAN "${build}/CMakeCache.txt") # or there is none yet
    file(REMOVE_RECURSE "${build}" "${PLUGINS}/${name}")
endif()
set(ENV{CMAKE_C_COMPILER_LAUNCHER} "${LAUNCHER}")
set(ENV{CMAKE_CXX_COMPILER_LAUNCHER} "${LAUNCHER}")
quietly("${CMAKE_COMMAND}" -G Ninja -S "${SOURCE}" -B "${build}" "-DCMAKE_PREFIX_PATH=${SDK}" "-DCMAKE_BUILD_TYPE=${BUILD_TYPE}"
        -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF -DCMAKE_COMPILE_WARNING_AS_ERROR=ON
        "-DCMAKE_LIBRARY_OUTPUT_DIRECTORY=${PLUGINS}/${name}" ${arguments})
quietly("${CMAKE_COMMAND}" --build "${build}" --parallel 2)
file(TOUCH "${STAMP}")
