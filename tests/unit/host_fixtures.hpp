/// What the tests of the host share.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "host/error.hpp"

namespace pelorus::host::test {

/// The library of tests/fixtures/CMakeLists.txt of that name.
inline std::filesystem::path fixture(const std::string& name) {
    return std::filesystem::path(PELORUS_BUILD_DIR) / "fixtures" / name / (name + ".so");
}

/// A folder of its own that goes away with the object.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "pelorus-XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
        path_ = std::filesystem::canonical(pattern);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Copies a fixture to that place below the folder.
    std::filesystem::path copy(const std::string& name, const std::filesystem::path& to) const {
        std::filesystem::create_directories((path_ / to).parent_path());
        std::filesystem::copy_file(fixture(name), path_ / to, std::filesystem::copy_options::overwrite_existing);
        return path_ / to;
    }
    std::filesystem::path write(const std::filesystem::path& to, const std::string& bytes) const {
        std::ofstream(path_ / to, std::ios::binary) << bytes;
        return path_ / to;
    }

private:
    std::filesystem::path path_;
};

inline std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The text of the Error that the call throws, or "" if it throws none.
template <class Call> std::string error_of(Call&& call) {
    try {
        call();
        return {};
    } catch (const Error& error) {
        return error.what();
    }
}

}  // namespace pelorus::host::test
