#include "temporary_folder.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>

namespace pelorus::conformance {

namespace fs = std::filesystem;

namespace {

fs::path home;  // of this process; of the system's unless set

fs::path folder_of_temporaries() {
    if (!home.empty()) return home;
    const fs::path memory = "/dev/shm";
    return access(memory.c_str(), W_OK | X_OK) == 0 ? memory : fs::temp_directory_path();
}

}  // namespace

std::map<std::string, std::string> contents_of(const fs::path& folder) {
    std::map<std::string, std::string> contents;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        std::string& content = contents[entry.path().lexically_relative(folder).string()];
        if (!entry.is_regular_file()) continue;
        std::ifstream stream(entry.path(), std::ios::binary);
        std::ostringstream text;
        text << stream.rdbuf();
        content = text.str();
    }
    return contents;
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (folder_of_temporaries() / "pelorus-conform-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
        throw std::system_error(errno, std::generic_category(), "cannot make a temporary folder " + name);
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

void TemporaryFolder::clear() const {
    for (const auto& entry : fs::directory_iterator(path_)) fs::remove_all(entry.path());
}

void TemporaryFolder::become_home() const {
    fs::current_path(path_);
    home = path_;
}

}  // namespace pelorus::conformance
