# Link options of single saboteurs of library.c, in place of those that all others have; and their search paths.

set(plugin_map "-Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/plugin.map")
set(options_library-exports-one-symbol -Wl,-z,defs) # no version script: what is visible is exported
set(options_library-exports-one-symbol.near -Wl,-z,defs
    "-Wl,--version-script=${CMAKE_CURRENT_SOURCE_DIR}/saboteurs/library/versioned.map")
set(options_library-symbols-resolved -Wl,-z,undefs ${plugin_map})
set(options_library-stack-not-executable -Wl,-z,defs,-z,execstack ${plugin_map})
set(options_library-stack-not-executable.near -Wl,-z,defs,-z,noexecstack ${plugin_map})
set(options_library-search-path-is-absolute -Wl,-z,defs,-rpath,lib ${plugin_map})
set(rpath_library-search-path-is-absolute.near "$ORIGIN/../lib;/usr/local/lib")
