#include "report/browser.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>
#include <thread>

#include <sodium.h>

#include "host/error.hpp"
#include "report/json_file.hpp"

extern char** environ;

namespace pelorus::report {

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds patience{120};

/// Of the browser's own: profile, output. Gone in the end.
class Folder {
public:
    Folder() {
        std::string name = (fs::temp_directory_path() / "pelorus-browser-XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr)
            throw Error(Exit::run_failed, "cannot make a folder in " + fs::temp_directory_path().string());
        path_ = name;
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    fs::path path() const { return path_; }

private:
    fs::path path_;
};

std::string read(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Waits for the child and what it has started; kills them when it takes too long.
bool ends_well(::pid_t child) {
    const auto end = std::chrono::steady_clock::now() + patience;
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0) {
        if (std::chrono::steady_clock::now() > end) {
            ::kill(-child, SIGKILL);
            ::waitpid(child, &status, 0);
            return false;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Starts the program in a process group of its own, its output and errors in files.
bool run(const std::vector<std::string>& words, const fs::path& output, const fs::path& errors) {
    std::vector<char*> arguments;
    for (const std::string& word : words)
        arguments.push_back(const_cast<char*>(word.c_str()));  // POSIX takes char*, and leaves them alone
    arguments.push_back(nullptr);
    ::posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&files, 1, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::posix_spawn_file_actions_addopen(&files, 2, errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::posix_spawnattr_t attributes;
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    ::pid_t child = 0;
    const int failed = ::posix_spawn(&child, arguments[0], &files, &attributes, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&files);
    ::posix_spawnattr_destroy(&attributes);
    return failed == 0 && ends_well(child);
}

/// What the page has become once it has exported its plots.
std::string exported_document(const fs::path& page, const std::string& format) {
    const fs::path browser = find_browser();
    if (browser.empty())
        throw Error(
            Exit::run_failed,
            "--plot: there is no chromium on the PATH, which draws the plots; on Debian: apt-get install chromium");
    const Folder folder;
    std::vector<std::string> words{browser.string(),
                                   "--headless",
                                   "--disable-gpu-sandbox",
                                   "--use-angle=swiftshader",
                                   "--enable-unsafe-swiftshader",
                                   "--disable-dev-shm-usage",
                                   "--no-first-run",
                                   "--user-data-dir=" + (folder.path() / "profile").string(),
                                   "--virtual-time-budget=60000",
                                   "--dump-dom",
                                   "file://" + fs::absolute(page).string() + "#export=" + format};
    if (::geteuid() == 0) words.insert(words.begin() + 1, "--no-sandbox");  // the sandbox refuses to run as root
    const bool well = run(words, folder.path() / "document", folder.path() / "errors");
    std::string document = read(folder.path() / "document");
    if (!well || document.find("id=\"exported\"") == std::string::npos)
        throw Error(Exit::run_failed, "--plot: " + browser.string() + " did not draw the plots of " + page.string());
    return document;
}

std::string decoded(const std::string& base64) {
    std::string bytes(base64.size(), '\0');
    std::size_t size = 0;
    if (::sodium_base642bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), base64.data(), base64.size(),
                            "\n", &size, nullptr, sodium_base64_VARIANT_ORIGINAL) != 0)
        throw Error(Exit::run_failed, "--plot: the browser handed over a plot that cannot be read");
    bytes.resize(size);
    return bytes;
}

/// `%3C` is `<`.
std::string without_percents(const std::string& text) {
    std::string bytes;
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned code = 0;
        const char* const first = text.data() + i + 1;
        if (text[i] == '%' && i + 2 < text.size() && std::from_chars(first, first + 2, code, 16).ptr == first + 2) {
            bytes += static_cast<char>(code);
            i += 2;
        } else {
            bytes += text[i];
        }
    }
    return bytes;
}

/// What a `data:` address holds.
std::string content_of(const std::string& address) {
    const std::size_t comma = address.find(',');
    if (comma == std::string::npos) throw Error(Exit::run_failed, "--plot: the browser handed over no plot");
    const std::string content = address.substr(comma + 1);
    return address.compare(comma - std::min<std::size_t>(comma, 7), 7, ";base64") == 0 ? decoded(content)
                                                                                       : without_percents(content);
}

std::string attribute(const std::string& text, std::size_t from, const std::string& name) {
    const std::size_t begin = text.find(name + "=\"", from) + name.size() + 2;
    return text.substr(begin, text.find('"', begin) - begin);
}

}  // namespace

fs::path find_browser() {
    const char* path = std::getenv("PATH");
    std::istringstream folders(path == nullptr ? "" : path);
    std::vector<fs::path> all;
    for (std::string folder; std::getline(folders, folder, ':');) all.emplace_back(folder);
    for (const char* name : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"})
        for (const fs::path& folder : all)
            if (folder.is_absolute() && ::access((folder / name).c_str(), X_OK) == 0) return folder / name;
    return {};
}

std::vector<std::string> write_plots(const fs::path& page, const fs::path& folder, const std::string& format) {
    const std::string document = exported_document(page, format), mark = "data-figure=\"";
    std::error_code reason;
    fs::create_directories(folder, reason);
    if (reason) throw Error(Exit::run_failed, "cannot make " + folder.string() + ": " + reason.message());
    std::vector<std::string> names;
    for (std::size_t at = document.find(mark); at != std::string::npos; at = document.find(mark, at + 1)) {
        const std::string name = attribute(document, at, "data-figure") + "." + format,
                          source = attribute(document, at, "src");
        write_file(folder / name, content_of(source));
        names.push_back(name);
    }
    return names;
}

}  // namespace pelorus::report
