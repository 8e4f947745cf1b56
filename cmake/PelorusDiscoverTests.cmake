# Makes one ctest test of every Catch2 case, when ctest starts (not when the executable is linked, which would slow
# down builds and fail them when a test crashes early). Tags become what ctest understands:
#
#     [release-only]  label: not run under the sanitizers (malloc interposed, timing, memory)
#     [long]          label: only run by tools/test --full
#     [serial]        never beside another test
#     [.]             not run by ctest at all
#
# With BY_SOURCE, one test of all cases of a source file that have no such tag: an executable with sanitizers takes half a second to
# start.

cmake_policy(VERSION 3.25) # ctest reads this file too, and sets no policies

if(DEFINED PROJECT_NAME) # not in ctest
    function(pelorus_discover_tests target)
        cmake_parse_arguments(PARSE_ARGV 1 arg "BY_SOURCE" "" "")
        set(sources "")
        if(arg_BY_SOURCE)
            get_target_property(sources ${target} SOURCES)
            list(FILTER sources INCLUDE REGEX "_test\\.cpp$")
            list(TRANSFORM sources REPLACE "^.*/|\\.cpp$" "")
        endif()
        set(include_file "${CMAKE_CURRENT_BINARY_DIR}/${target}_tests.cmake")
        file(GENERATE OUTPUT "${include_file}" CONTENT
"include([==[${CMAKE_SOURCE_DIR}/cmake/PelorusDiscoverTests.cmake]==])
pelorus_add_catch_tests(${target} [==[$<TARGET_FILE:${target}>]==] [==[${CMAKE_CURRENT_BINARY_DIR}]==] [==[${sources}]==])
")
        set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${include_file}")
    endfunction()
endif()

# Names of the cases that a Catch2 test spec selects.
function(pelorus_list_catch_tests out executable spec)
    # Catch2 v2 exits with the number of tests here, so only a crash can be told by the result.
    execute_process(COMMAND "${executable}" "${spec}" --filenames-as-tags --list-test-names-only
                    OUTPUT_VARIABLE names ERROR_VARIABLE errors RESULT_VARIABLE result OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT result MATCHES "^[0-9]+$" OR errors)
        message(FATAL_ERROR "${executable} does not tell its tests: ${result} ${errors}")
    endif()
    if(names MATCHES "[][;\\]")
        message(FATAL_ERROR "${executable}: a test's name must not contain any of [ ] ; \\")
    endif()
    string(REPLACE "\n" ";" names "${names}")
    set(${out} "${names}" PARENT_SCOPE)
endfunction()

function(pelorus_add_catch_tests target executable folder sources)
    if(NOT EXISTS "${executable}")
        add_test(${target}-not-built "${executable}")
        return()
    endif()
    pelorus_list_catch_tests(alone "${executable}" "~[.]")
    foreach(tag release-only long serial)
        pelorus_list_catch_tests(tagged_${tag} "${executable}" "[${tag}]")
    endforeach()
    foreach(source IN LISTS sources)
        set(spec "[#${source}]~[.]~[release-only]~[long]~[serial]")
        pelorus_list_catch_tests(names "${executable}" "${spec}")
        if(names)
            pelorus_add_catch_test(${target} "${executable}" "${folder}" "${source}" "${spec}" "")
            list(REMOVE_ITEM alone ${names})
        endif()
    endforeach()
    foreach(name IN LISTS alone)
        string(REPLACE "," "\\," spec "${name}") # a bare comma would mean "or"
        set(labels "")
        foreach(tag release-only long)
            if(name IN_LIST tagged_${tag})
                list(APPEND labels ${tag})
            endif()
        endforeach()
        pelorus_add_catch_test(${target} "${executable}" "${folder}" "${name}" "${spec}" "${labels}")
        if(name IN_LIST tagged_serial)
            set_tests_properties("${target}: ${name}" PROPERTIES RUN_SERIAL TRUE)
        endif()
    endforeach()
endfunction()

function(pelorus_add_catch_test target executable folder name spec labels)
    # NoTests: a name that selects nothing fails instead of passing with no assertion run.
    add_test("${target}: ${name}" "${executable}" "${spec}" --filenames-as-tags -w NoTests)
    set_tests_properties("${target}: ${name}" PROPERTIES LABELS "${target};${labels}" WORKING_DIRECTORY "${folder}" TIMEOUT 900)
endfunction()
