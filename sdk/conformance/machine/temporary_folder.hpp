/// Places on the disk for what a plugin writes.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace pelorus::conformance {

/// All that is in a folder by relative name: content of files, "" for folders.
std::map<std::string, std::string> contents_of(const std::filesystem::path& folder);

/// A folder of its own, in memory where the system has such a place (sinks wait for the disk when they complete a file); gone with
/// the object.
class TemporaryFolder {
public:
    /// Throws std::system_error if there cannot be one.
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const noexcept { return path_; }
    std::map<std::string, std::string> contents() const { return contents_of(path_); }
    void clear() const;

    /// From now on this process works here, and all its temporary folders lie below: whoever made this one removes them, too.
    void become_home() const;

private:
    std::filesystem::path path_;
};

}  // namespace pelorus::conformance
