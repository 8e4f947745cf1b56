/// A project made by `pelorus new`, built as its author would.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "../support/process.hpp"

namespace pelorus::test {

/// SHA-256 of the command and of libpelorus.so, as one text.
std::string host_sha256();

class ProjectBuild {
public:
    /// Makes the project anew in the build tree.
    ProjectBuild(const std::string& kind, const std::string& name, const std::string& folder_suffix = "");

    /// Configures with the installed SDK and nothing else of Pelorus, builds without a warning, and copies the libraries into
    /// plugins(). `cmake_flags` are appended.
    void build(const std::vector<std::string>& cmake_flags = {}) const;
    /// Runs the project's config.yaml with plugins(); `flags` are appended.
    Ended run_config(const std::vector<std::string>& flags = {}) const;

    std::filesystem::path folder() const { return root_ / name_; }
    std::filesystem::path plugins() const { return root_ / "plugins"; }
    std::filesystem::path results() const { return root_ / "results"; }

private:
    std::string name_;
    std::filesystem::path root_;
};

}  // namespace pelorus::test
