/// Finds plugins, checks them before any of their code runs, loads them once and keeps them for ever.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <pelorus/abi/abi.h>

#include "host/error.hpp"

namespace pelorus::host {

/// What a manifest says, read from the ELF file without loading it.
struct PluginFile {
    std::string id, kind, table_id, version;
    std::uint16_t abi_major = 0, abi_minor = 0;
    std::filesystem::path library;  ///< absolute, symbolic links resolved
};

/// A library or folder that was found but is not used, and why (one line).
struct RejectedFile {
    std::filesystem::path library;
    std::string reason;
    std::vector<std::string> ids;  ///< of the plugins in it, as far as they are known
};

struct Library;

/// A plugin whose library is loaded, held by the catalog; `plugin` itself lives as long as the process.
struct LoadedPlugin {
    PluginFile file;
    const plr_plugin* plugin = nullptr;
    const Library* library = nullptr;
    /// Of the library's file, hexadecimal; see sha256_of.
    std::string sha256() const;
    const plr_description& description() const { return *plugin->description; }
};

/// There is no plugin of that id.
class UnknownPlugin : public Error {
public:
    UnknownPlugin(const std::string& line, std::string meant) : Error(Exit::misuse, line), meant_(std::move(meant)) {}
    /// The id that was surely meant, or "". The line suggests ids that are less near, too.
    const std::string& meant() const noexcept { return meant_; }

private:
    std::string meant_;
};

class Catalog {
public:
    /// Folders to search, in order: `--plugins`, PELORUS_PLUGIN_PATH, ../lib/pelorus from the executable's folder, pelorus beside
    /// libpelorus.so; each once. Relative ones
    /// are made absolute, empty ones left out: the current directory is never searched unless it is named.
    static std::vector<std::filesystem::path> default_folders(
        const std::vector<std::filesystem::path>& from_command_line);

    /// Reads the manifests of all libraries (*.so) below the folders. Loads nothing. Never fails: see rejected().
    explicit Catalog(std::vector<std::filesystem::path> folders);

    const std::vector<std::filesystem::path>& folders() const noexcept { return folders_; }
    /// Sorted by id. Where two libraries have the same id, the one found first; load() of that id fails, unless the others are
    /// examples (is_example).
    const std::vector<PluginFile>& plugins() const noexcept { return plugins_; }
    const std::vector<RejectedFile>& rejected() const noexcept { return rejected_; }
    /// The manifest of that id, or nullptr.
    const PluginFile* find(const std::string& id) const noexcept;

    /// Loads the plugin (once) and checks that it is what its manifest says. Throws Error (Exit::misuse) naming id, library,
    /// what was wrong and, for an unknown id (UnknownPlugin), the folders searched and the nearest id. Thread-safe.
    const LoadedPlugin& load(const std::string& id);

private:
    void add(const std::filesystem::path& library);
    const PluginFile& require(const std::string& id) const;

    std::vector<std::filesystem::path> folders_;
    std::vector<PluginFile> plugins_;
    std::vector<RejectedFile> rejected_;
    std::map<std::string, std::filesystem::path> clashes_;  // id -> the second library that has it
    std::mutex mutex_;
    std::map<std::string, std::unique_ptr<LoadedPlugin>> loaded_;
};

}  // namespace pelorus::host
