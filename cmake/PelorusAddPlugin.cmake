# pelorus_add_plugin(NAME
#     SOURCES file...           C or C++ (other languages: add an object library's $<TARGET_OBJECTS:...>)
#     [KIND kind]               target KIND_NAME in folder KIND/, so that a motion and a sensor may share a name
#     [OUTPUT_SUBDIR folder]    another folder than KIND
#     [INCLUDE folder...]
#     [LIBRARIES library...]
#     [TESTS file...])          Catch2 cases for the tree's plugin_tests, and those of SOURCES that they use (in the Pelorus tree only)
#
# Makes NAME.so, a library that exports `plr_entry` and nothing else. Out of tree it lies in the build folder (or in
# CMAKE_LIBRARY_OUTPUT_DIRECTORY), ready to be copied into a plugin folder.
function(pelorus_add_plugin NAME)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "KIND;OUTPUT_SUBDIR" "SOURCES;INCLUDE;LIBRARIES;TESTS")
    if(arg_UNPARSED_ARGUMENTS OR arg_KEYWORDS_MISSING_VALUES OR NOT arg_SOURCES)
        message(FATAL_ERROR "pelorus_add_plugin(${NAME}): SOURCES missing, or not understood: "
                            "${arg_UNPARSED_ARGUMENTS} ${arg_KEYWORDS_MISSING_VALUES}")
    endif()

    set(target ${NAME})
    set(subdir "${arg_OUTPUT_SUBDIR}")
    if(arg_KIND)
        set(target ${arg_KIND}_${NAME})
        if(NOT subdir)
            set(subdir ${arg_KIND})
        endif()
    endif()
    if(PELORUS_PLUGIN_ROOT) # set by the Pelorus tree
        set(root "${PELORUS_PLUGIN_ROOT}")
    elseif(CMAKE_LIBRARY_OUTPUT_DIRECTORY)
        set(root "${CMAKE_LIBRARY_OUTPUT_DIRECTORY}")
    else()
        set(root "${CMAKE_CURRENT_BINARY_DIR}")
    endif()

    # What a plugin's tests use of its sources is compiled once for both.
    set(compiled ${target})
    set(objects "")
    set(common ${arg_SOURCES})
    list(FILTER common INCLUDE REGEX "[.](c|cpp)$")
    foreach(source IN LISTS arg_SOURCES)
        if(NOT source IN_LIST arg_TESTS)
            list(REMOVE_ITEM common "${source}")
        endif()
    endforeach()
    if(common)
        list(REMOVE_ITEM arg_SOURCES ${common})
        list(REMOVE_ITEM arg_TESTS ${common})
        add_library(${target}_common OBJECT ${common})
        list(APPEND compiled ${target}_common)
        set(objects $<TARGET_OBJECTS:${target}_common>)
    endif()

    add_library(${target} MODULE ${arg_SOURCES} ${objects})
    foreach(each IN LISTS compiled)
        target_link_libraries(${each} PRIVATE PelorusSDK::sdk ${arg_LIBRARIES})
        target_include_directories(${each} PRIVATE ${arg_INCLUDE})
        set_target_properties(${each} PROPERTIES
            C_STANDARD 11
            CXX_STANDARD 17
            CXX_STANDARD_REQUIRED ON
            POSITION_INDEPENDENT_CODE ON
            # Symbols of two plugins never meet: everything is hidden but what the SDK marks as exported.
            C_VISIBILITY_PRESET hidden
            CXX_VISIBILITY_PRESET hidden
            VISIBILITY_INLINES_HIDDEN ON)
        if(TARGET pelorus_warnings) # the Pelorus tree; other authors choose their own warnings
            target_link_libraries(${each} PRIVATE pelorus_warnings pelorus_race_detector)
        endif()
    endforeach()
    target_link_libraries(${target} PRIVATE m) # C does not bring it by itself
    set_target_properties(${target} PROPERTIES
        OUTPUT_NAME ${NAME}
        PREFIX ""
        SUFFIX ".so"
        LIBRARY_OUTPUT_DIRECTORY "${root}/${subdir}"
        # Libraries that a plugin brings along lie beside it or in the host's lib folder, two above lib/pelorus/KIND.
        BUILD_WITH_INSTALL_RPATH ON
        INSTALL_RPATH "$ORIGIN;$ORIGIN/../..")
    # An undefined symbol is an error now, not when the host loads the plugin. The version script leaves one symbol to be
    # seen: visibility alone does not hide weak template instances of the standard library, nor what a static library brings.
    target_link_options(${target} PRIVATE -Wl,-z,defs -Wl,--exclude-libs,ALL
                        "-Wl,--version-script=${CMAKE_CURRENT_FUNCTION_LIST_DIR}/plugin.map")

    if(TARGET pelorus_warnings)
        set_property(GLOBAL APPEND PROPERTY PELORUS_PLUGINS ${target})
    endif()

    if(arg_TESTS)
        if(NOT PELORUS_PLUGIN_ROOT)
            message(FATAL_ERROR "pelorus_add_plugin(${NAME}): TESTS works in the Pelorus tree only")
        endif()
        list(TRANSFORM arg_TESTS PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
        set_property(GLOBAL APPEND PROPERTY PELORUS_PLUGIN_TESTS ${arg_TESTS} ${objects})
        set_property(GLOBAL APPEND PROPERTY PELORUS_PLUGIN_TEST_LIBRARIES ${arg_LIBRARIES})
    endif()
endfunction()
