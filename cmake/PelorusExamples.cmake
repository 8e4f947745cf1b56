# The examples of the SDK (sdk/examples), each a project of its own: configured and built out of tree against the installed SDK
# alone, as its author would, by cmake/build_example.cmake. Their plugins go to lib/pelorus/examples of the build tree, where its
# `pelorus` finds them; they are not installed with the host. Target `examples`; what lies below examples/ is the projects' builds.
# A build with sanitizers goes without: what they show, the release build shows, and other compilers' code would not be instrumented.

if(PELORUS_SANITIZE)
    return()
endif()

set(PELORUS_EXAMPLE_PLUGINS "${PROJECT_BINARY_DIR}/lib/pelorus/examples")
set(example_builds "${PROJECT_BINARY_DIR}/examples")
set(script "${PROJECT_SOURCE_DIR}/cmake/build_example.cmake")

set(settings "${PROJECT_BINARY_DIR}/example-settings.cmake")
file(CONFIGURE OUTPUT "${settings}" @ONLY CONTENT [=[
set(SDK "@PELORUS_SDK_INSTALL@")
set(BUILDS "@example_builds@")
set(PLUGINS "@PELORUS_EXAMPLE_PLUGINS@")
set(BUILD_TYPE "@CMAKE_BUILD_TYPE@")
set(LAUNCHER "@CMAKE_CXX_COMPILER_LAUNCHER@")
]=])

file(GLOB example_projects CONFIGURE_DEPENDS sdk/examples/*/CMakeLists.txt)
set(example_stamps "")
set(PELORUS_EXAMPLES "")
foreach(project_file IN LISTS example_projects)
    get_filename_component(folder "${project_file}" DIRECTORY)
    get_filename_component(name "${folder}" NAME)
    list(APPEND PELORUS_EXAMPLES ${name})
    file(GLOB files CONFIGURE_DEPENDS LIST_DIRECTORIES false "${folder}/*")
    set(stamp "${example_builds}/${name}.built")
    # Where a compiler is missing no stamp is made: the next build tries again.
    add_custom_command(OUTPUT "${stamp}"
                       COMMAND "${CMAKE_COMMAND}" "-DSETTINGS=${settings}" "-DSOURCE=${folder}" "-DSTAMP=${stamp}" -P "${script}"
                       DEPENDS sdk_install "${PELORUS_SDK_INSTALL}/.installed" "${settings}" "${script}" ${files}
                       COMMENT "Building the example ${name} against the installed SDK" VERBATIM)
    list(APPEND example_stamps "${stamp}")
endforeach()
add_custom_target(examples ALL DEPENDS ${example_stamps})

# What was built of an example that is not there any more would still be found.
file(GLOB built RELATIVE "${PELORUS_EXAMPLE_PLUGINS}" "${PELORUS_EXAMPLE_PLUGINS}/*")
foreach(name IN LISTS built)
    if(NOT name IN_LIST PELORUS_EXAMPLES)
        file(REMOVE_RECURSE "${PELORUS_EXAMPLE_PLUGINS}/${name}" "${example_builds}/${name}")
    endif()
endforeach()
