#include "project_build.hpp"

#include <catch2/catch.hpp>

namespace pelorus::test {

namespace fs = std::filesystem;

namespace {

void require_success(const std::vector<std::string>& words) {
    const Ended ended = run(words);
    CAPTURE(words, ended.out, ended.err);
    REQUIRE(ended.exit == 0);
}

bool has_ccache() { return run({"sh", "-c", "command -v ccache"}).exit == 0; }

}  // namespace

std::string host_sha256() {
    const Ended ended = run({"sha256sum", PELORUS_EXECUTABLE, PELORUS_BUILD_DIR "/lib/libpelorus.so"});
    REQUIRE(ended.exit == 0);
    return ended.out;
}

ProjectBuild::ProjectBuild(const std::string& kind, const std::string& name, const std::string& folder_suffix)
    : name_(name), root_(fs::path(PELORUS_BUILD_DIR) / "tests" / "projects" / (kind + folder_suffix)) {
    fs::remove_all(root_);
    fs::create_directories(plugins());
    require_success({PELORUS_EXECUTABLE, "new", kind, name, "--dir", root_.string()});
}

void ProjectBuild::build(const std::vector<std::string>& cmake_flags) const {
    const fs::path build = folder() / "build";
    std::vector<std::string> configure = {"cmake",
                                          "-G",
                                          "Ninja",
                                          "-S",
                                          folder().string(),
                                          "-B",
                                          build.string(),
                                          "-DCMAKE_BUILD_TYPE=Debug",
                                          "-DCMAKE_CXX_FLAGS_DEBUG=-O0",
                                          "-DCMAKE_COMPILE_WARNING_AS_ERROR=ON",
                                          "-DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF",
                                          "-DCMAKE_PREFIX_PATH=" PELORUS_SDK_INSTALL};
    if (has_ccache()) configure.emplace_back("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache");
    configure.insert(configure.end(), cmake_flags.begin(), cmake_flags.end());
    require_success(configure);
    const std::string rules = read_file(build / "build.ninja");
    REQUIRE(count(rules, PELORUS_SDK_INSTALL "/include") > 0);
    REQUIRE(count(rules, PELORUS_SOURCE_DIR "/sdk") + count(rules, PELORUS_SOURCE_DIR "/framework") == 0);
    require_success({"cmake", "--build", build.string(), "-j", "2"});
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(build))
        if (entry.path().extension() == ".so") fs::copy_file(entry.path(), plugins() / entry.path().filename());
    REQUIRE(fs::exists(plugins() / (name_ + ".so")));
}

Ended ProjectBuild::run_config(const std::vector<std::string>& flags) const {
    std::vector<std::string> words = {"run",   "config.yaml",     "--plugins", plugins().string(),
                                      "--out", results().string()};
    words.insert(words.end(), flags.begin(), flags.end());
    ProcessOptions options;
    options.folder = folder();
    return pelorus_command(words, options);
}

}  // namespace pelorus::test
