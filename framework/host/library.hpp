/// Libraries in this process: loaded once, started once, never unloaded.
#pragma once

#include <filesystem>
#include <string>

#include <pelorus/abi/entry.h>

namespace pelorus::host {

struct Library {
    std::filesystem::path path;  ///< canonical
    const plr_entry_point* entry = nullptr;
};

/// Loads the library (absolute path) unless this process has it already, checks its entry point and calls its init.
/// deinit runs when the process ends, the last library's first. A library whose init failed stays refused. Throws Error
/// (Exit::misuse) that says what was wrong but not which library: the caller knows more. Thread-safe.
const Library& load_library(const std::filesystem::path& path);

/// SHA-256, hexadecimal, of the file that was loaded, even where another has taken its name since; "" if it cannot be read any
/// more. Worked out when first asked for, because that takes longer than loading. Thread-safe.
std::string sha256_of(const Library& library);

/// The plugin of that id, from the library's factory; never nullptr. Throws Error like load_library. Thread-safe.
const plr_plugin& make_plugin(const Library& library, const std::string& id);

}  // namespace pelorus::host
