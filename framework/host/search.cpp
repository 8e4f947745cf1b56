#include "host/search.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <system_error>

#include "host/plugin_error.hpp"

namespace pelorus::host {

namespace fs = std::filesystem;

namespace {

class Search {
public:
    explicit Search(std::vector<RejectedFile>& rejected) : rejected_(rejected) {}

    void folder(const fs::path& path) {
        std::error_code error;
        const fs::path canonical = fs::canonical(path, error);
        if (error) return reject(path, error);
        if (fs::is_regular_file(canonical, error)) return entry(canonical);
        if (!folders_seen_.insert(canonical).second) return;
        std::vector<fs::path> entries;
        for (fs::directory_iterator it(canonical, error), end; !error && it != end; it.increment(error))
            entries.push_back(it->path());
        if (error) reject(canonical, error);
        std::sort(entries.begin(), entries.end());  // the order of a folder is the file system's whim
        for (const fs::path& entry : entries) this->entry(entry);
    }

    std::vector<fs::path> take() { return std::move(libraries_); }

private:
    void entry(const fs::path& path) {
        std::error_code error;
        const fs::file_status status = fs::status(path, error);
        if (fs::is_directory(status)) return folder(path);
        if (path.extension() != ".so") return;
        if (error) return reject(path, error);
        if (!fs::is_regular_file(status)) return;
        const fs::path canonical = fs::canonical(path, error);
        if (error) return reject(path, error);
        if (files_seen_.insert(canonical).second) libraries_.push_back(canonical);
    }

    void reject(const fs::path& path, const std::error_code& error) {
        rejected_.push_back({path, "cannot be searched: " + error.message(), {}});
    }

    std::vector<RejectedFile>& rejected_;
    std::set<fs::path> folders_seen_, files_seen_;
    std::vector<fs::path> libraries_;
};

}  // namespace

std::vector<fs::path> find_libraries(const std::vector<fs::path>& folders, std::vector<RejectedFile>& rejected) {
    Search search(rejected);
    for (const fs::path& folder : folders) search.folder(folder);
    return search.take();
}

std::string why_unsafe(const fs::path& library) {
    const auto has = [](fs::perms perms, fs::perms bit) { return (perms & bit) != fs::perms::none; };
    std::error_code error;
    const fs::perms file = fs::status(library, error).permissions();
    if (error) return "cannot be examined: " + error.message();
    if (has(file, fs::perms::others_write)) return "anyone may write this file (chmod o-w it)";
    const fs::perms folder = fs::status(library.parent_path(), error).permissions();
    if (error) return "its folder cannot be examined: " + error.message();
    if (has(folder, fs::perms::others_write) && !has(folder, fs::perms::sticky_bit))
        return "anyone may replace files in its folder (chmod o-w the folder)";
    return {};
}

bool is_example(const fs::path& library) {
    return library.string().find("/lib/pelorus/examples/") != std::string::npos;
}

std::vector<fs::path> Catalog::default_folders(const std::vector<fs::path>& from_command_line) {
    std::vector<fs::path> folders;
    const auto add = [&folders](const fs::path& folder) {
        if (folder.empty()) return;
        const fs::path absolute = fs::absolute(folder).lexically_normal();
        if (std::find(folders.begin(), folders.end(), absolute) == folders.end()) folders.push_back(absolute);
    };
    for (const fs::path& folder : from_command_line) add(folder);
    if (const char* variable = std::getenv("PELORUS_PLUGIN_PATH")) {
        const std::string path = variable;
        for (std::size_t begin = 0; begin <= path.size();) {
            const std::size_t end = std::min(path.find(':', begin), path.size());
            add(path.substr(begin, end - begin));
            begin = end + 1;
        }
    }
    std::error_code error;
    const fs::path executable = fs::read_symlink("/proc/self/exe", error);
    if (!error) add(executable.parent_path().parent_path() / "lib" / "pelorus");
    // Whoever embeds the host has an executable somewhere else: the plugins lie beside the library then.
    Dl_info library{};
    static const char somewhere_in_it = 0;
    if (dladdr(&somewhere_in_it, &library) != 0 && library.dli_fname != nullptr) {
        const fs::path file = fs::canonical(library.dli_fname, error);
        if (!error) add(file.parent_path() / "pelorus");
    }
    return folders;
}

}  // namespace pelorus::host
