/// Which files plugins are looked for in, and which of them are safe to load.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/catalog.hpp"

namespace pelorus::host {

/// All `.so` files below the folders, canonical, each once: by folder, then by path. Symbolic links are followed, loops end. In
/// place of a folder a library may be named.
/// What could not be searched, and why, is appended to `rejected`.
std::vector<std::filesystem::path> find_libraries(const std::vector<std::filesystem::path>& folders,
                                                  std::vector<RejectedFile>& rejected);

/// Why nobody should load this file, or "": whoever may write a library, or replace it, runs code in this process.
std::string why_unsafe(const std::filesystem::path& library);

/// Whether a library is the build tree's own build of an example of the SDK, in lib/pelorus/examples: it gives way to another
/// library with the same plugin, so that whoever builds an example, to change it, need not remove that one.
bool is_example(const std::filesystem::path& library);

}  // namespace pelorus::host
