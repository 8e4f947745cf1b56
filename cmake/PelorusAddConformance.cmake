# pelorus_add_conformance(TARGET
#     [SUBJECTS file]   what is tried, see `pelorus help conform`. Unless given: conformance.yaml beside the CMakeLists.txt or,
#                       if there is none, the defaults and each single choice
#     [LEVEL 1..5]      3 unless given
#     [WHOLE])          one test of levels 1 to 3 and one, labelled `long`, of all levels; else one test a check
#
# Testing need not have been enabled before. With BUILD_TESTING off (see CTest) nothing is added.
# Adds the conformance suites on the library of TARGET (see pelorus_add_plugin) to ctest, as `conformance: TARGET: CHECK` or
# `conformance: TARGET`. Which checks there are is asked when ctest starts: they depend on the kinds of the library's plugins.
if(DEFINED PROJECT_NAME) # not in ctest, which includes this file, too
    set(PELORUS_ADD_CONFORMANCE_FILE "${CMAKE_CURRENT_LIST_FILE}")
    function(pelorus_add_conformance TARGET)
        cmake_parse_arguments(PARSE_ARGV 1 arg "WHOLE" "SUBJECTS;LEVEL" "")
        if(arg_UNPARSED_ARGUMENTS)
            message(FATAL_ERROR "pelorus_add_conformance(${TARGET}): not understood: ${arg_UNPARSED_ARGUMENTS}")
        elseif(arg_KEYWORDS_MISSING_VALUES)
            message(FATAL_ERROR "pelorus_add_conformance(${TARGET}): no value for ${arg_KEYWORDS_MISSING_VALUES}")
        elseif(NOT TARGET ${TARGET})
            message(FATAL_ERROR "pelorus_add_conformance(${TARGET}): there is no such target; pelorus_add_plugin(NAME KIND kind ...) "
                                "makes kind_NAME")
        endif()
        if(NOT arg_LEVEL)
            set(arg_LEVEL 3)
        endif()
        if(PELORUS_PLUGIN_ROOT AND NOT TARGET pelorus-conform) # the Pelorus tree, built with AddressSanitizer
            return()
        elseif(TARGET pelorus-conform) # the Pelorus tree
            set(runner "$<TARGET_FILE:pelorus-conform>")
        else()
            set(runner "${PELORUS_CONFORM}")
        endif()
        if(NOT arg_SUBJECTS AND EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/conformance.yaml")
            set(arg_SUBJECTS conformance.yaml)
        endif()
        set(options "")
        if(arg_SUBJECTS)
            get_filename_component(subjects "${arg_SUBJECTS}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
            list(APPEND options "--subjects=${subjects}")
        endif()
        if(DEFINED BUILD_TESTING AND NOT BUILD_TESTING)
            return()
        endif()
        # Not here, where it would last as long as the function; and from the first folder on, or ctest would not look further.
        set(folder "${CMAKE_CURRENT_SOURCE_DIR}")
        while(folder AND NOT CMAKE_TESTING_ENABLED)
            cmake_language(DEFER DIRECTORY "${folder}" CALL enable_testing)
            get_property(folder DIRECTORY "${folder}" PROPERTY PARENT_DIRECTORY)
        endwhile()
        set_property(GLOBAL APPEND PROPERTY PELORUS_CONFORMANCE_LIBRARIES "$<TARGET_FILE:${TARGET}>")
        if(arg_WHOLE)
            set(command "${runner}" "$<TARGET_FILE:${TARGET}>" ${options} --quiet)
            add_test(NAME "conformance: ${TARGET}" COMMAND ${command})
            add_test(NAME "conformance: ${TARGET}, all levels" COMMAND ${command} --level=5)
            set_tests_properties("conformance: ${TARGET}" PROPERTIES LABELS "conformance;release-only" TIMEOUT 300)
            set_tests_properties("conformance: ${TARGET}, all levels" PROPERTIES LABELS "conformance;release-only;long" TIMEOUT 600)
            return()
        endif()
        list(APPEND options --level=${arg_LEVEL})
        set(include_file "${CMAKE_CURRENT_BINARY_DIR}/${TARGET}_conformance.cmake")
        file(GENERATE OUTPUT "${include_file}" CONTENT
"include([==[${PELORUS_ADD_CONFORMANCE_FILE}]==])
pelorus_add_conformance_cases(${TARGET} [==[${runner}]==] [==[$<TARGET_FILE:${TARGET}>]==] [==[${options}]==] [==[${CMAKE_CURRENT_BINARY_DIR}]==])
")
        set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES "${include_file}")
    endfunction()
endif()

function(pelorus_add_conformance_cases target runner library options folder)
    if(NOT EXISTS "${library}")
        add_test("conformance: ${target}: not-built" "${runner}" "${library}")
        return()
    endif()
    execute_process(COMMAND "${runner}" "${library}" ${options} --names
                    OUTPUT_VARIABLE names ERROR_VARIABLE errors RESULT_VARIABLE result OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT result EQUAL 0)
        add_test("conformance: ${target}: library" "${runner}" "${library}" ${options}) # which tells what is wrong
        return()
    endif()
    string(REPLACE "\n" ";" names "${names}")
    # All are tried once, however many are asked for; then each test reads its verdict.
    set(report "${folder}/${target}_conformance.json")
    set(all "conformance: ${target}: all checks are tried")
    add_test("${all}" "${runner}" "${library}" ${options} "--json=${report}" --quiet)
    set_tests_properties("${all}" PROPERTIES FIXTURES_SETUP "conformance_${target}" LABELS conformance TIMEOUT 600
                                             PASS_REGULAR_EXPRESSION "levels 1 to") # not only if all is well
    foreach(name IN LISTS names)
        add_test("conformance: ${target}: ${name}" "${runner}" "${library}" "--from=${report}" "--only=${name}")
        set_tests_properties("conformance: ${target}: ${name}" PROPERTIES
            FIXTURES_REQUIRED "conformance_${target}" LABELS conformance
            SKIP_REGULAR_EXPRESSION "(^|\n)0 passed, [0-9]+ skipped;") # for all plugins of the library
    endforeach()
endfunction()
