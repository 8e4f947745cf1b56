# pelorus_add_lanes(NAME SOURCES file...)
#
# A static library NAME of kernels over lanes (plugins/common/lanes): each source is compiled once for every instruction set
# of the processor's family, with PELORUS_LANES naming the namespace of that set: baseline, avx2, avx512. Whoever links NAME
# chooses one when it is set up (lanes/instruction_set.hpp). Not by the loader (target_clones): resolvers run before the
# sanitizers are ready.
function(pelorus_add_lanes NAME)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES")
    if(arg_UNPARSED_ARGUMENTS OR NOT arg_SOURCES)
        message(FATAL_ERROR "pelorus_add_lanes(${NAME}): SOURCES missing, or not understood: ${arg_UNPARSED_ARGUMENTS}")
    endif()
    set(sets baseline)
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
        list(APPEND sets avx2 avx512)
    endif()
    set(options_avx2 -mavx2)
    set(options_avx512 -mavx512f)
    set(objects "")
    foreach(set IN LISTS sets)
        add_library(${NAME}_${set} OBJECT ${arg_SOURCES})
        target_link_libraries(${NAME}_${set} PRIVATE pelorus_warnings pelorus_race_detector PelorusSDK::sdk)
        target_compile_options(${NAME}_${set} PRIVATE ${options_${set}} -fno-math-errno)
        target_compile_definitions(${NAME}_${set} PRIVATE PELORUS_LANES=${set})
        set_target_properties(${NAME}_${set} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
        list(APPEND objects $<TARGET_OBJECTS:${NAME}_${set}>)
    endforeach()
    add_library(${NAME} STATIC ${objects})
endfunction()
