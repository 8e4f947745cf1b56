# Compiler and linker settings of everything in this tree. Plugins built out of tree choose their own.

# Results are the same bytes whatever the optimiser thinks of fused multiply-adds; so neither -march=native nor -ffast-math.
add_compile_options(-ffp-contract=off)
# No build path in the binaries: they are the same wherever the tree lies.
add_compile_options(-ffile-prefix-map=${CMAKE_SOURCE_DIR}/=)

add_library(pelorus_warnings INTERFACE)
target_compile_options(pelorus_warnings INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
if(PELORUS_WERROR)
    target_compile_options(pelorus_warnings INTERFACE -Werror)
endif()

# Plugins, their saboteurs and the suites, which call them from many threads: what ThreadSanitizer looks at. The host is not, so
# that this build has most of its objects in common with the release.
add_library(pelorus_race_detector INTERFACE)
if(PELORUS_SANITIZE STREQUAL "thread")
    target_compile_options(pelorus_race_detector INTERFACE -fsanitize=thread -O1)
    target_link_options(pelorus_race_detector INTERFACE -fsanitize=thread)
elseif(PELORUS_SANITIZE)
    add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
    if(NOT PELORUS_SANITIZE STREQUAL "full")
        # UBSan's checks of every single access double the time of compilation. Those of null and of an object's bounds are
        # AddressSanitizer's to find; alignment waits for the full build.
        add_compile_options(-fno-sanitize=null,object-size,pointer-overflow,alignment)
    endif()
    add_link_options(-fsanitize=address,undefined)
    add_compile_definitions(_GLIBCXX_ASSERTIONS)
    # The instrumentation hides initialisations from GCC's flow analysis; the release build keeps this warning.
    target_compile_options(pelorus_warnings INTERFACE -Wno-maybe-uninitialized)
endif()

find_program(PELORUS_CCACHE ccache)
if(PELORUS_CCACHE)
    # Paths below the tree are cached relative to it: a second clone of the tree hits as well.
    set(_launcher "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${CMAKE_SOURCE_DIR}" CCACHE_NOHASHDIR=1 "${PELORUS_CCACHE}")
    set(CMAKE_C_COMPILER_LAUNCHER ${_launcher})
    set(CMAKE_CXX_COMPILER_LAUNCHER ${_launcher})
endif()

find_program(PELORUS_MOLD mold)
if(PELORUS_MOLD)
    include(CheckLinkerFlag)
    check_linker_flag(CXX -fuse-ld=mold PELORUS_COMPILER_KNOWS_MOLD)
    if(PELORUS_COMPILER_KNOWS_MOLD)
        add_link_options(-fuse-ld=mold)
    endif()
endif()
