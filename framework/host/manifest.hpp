/// The manifests of a library, read from its file without loading it (ABI entry.h).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/catalog.hpp"

namespace pelorus::host {

struct Manifests {
    std::vector<PluginFile> plugins;  ///< empty if `problem` is set
    std::string problem;              ///< why this file is no Pelorus plugin, one line; or ""
};

/// Reads the ELF section `pelorus` of a regular file. Trusts nothing in it: truncated and malicious files answer a problem.
Manifests read_manifests(const std::filesystem::path& library);

}  // namespace pelorus::host
