// `pelorus new`: a plugin project, ready to build and run.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/output.hpp"
#include "cli/project.hpp"
#include "host/error.hpp"
#include "host/kinds.hpp"

namespace pelorus::cli {

namespace {

namespace fs = std::filesystem;

std::vector<std::string> kind_names() {
    std::vector<std::string> names;
    for (const host::Kind& kind : host::kinds) names.emplace_back(kind.name);
    return names;
}

std::string all_kinds() {
    std::string all;
    for (const std::string& name : kind_names()) all += (all.empty() ? "" : ", ") + name;
    return all;
}

/// The prefix under which CMake finds the SDK, or "" where it is not beside this executable.
fs::path sdk_prefix() {
    const fs::path root = executable_folder().parent_path();
    for (const fs::path& prefix : {root, root / "sdk-install"})
        if (fs::is_directory(prefix / "share" / "cmake" / "PelorusSDK")) return prefix;
    return {};
}

/// In single quotes where a shell would take it apart.
std::string quoted(const std::string& path) {
    if (path.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,@%=:") ==
        std::string::npos)
        return path;
    std::string out = "'";
    for (const char c : path) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::string next_steps(const Project& project) {
    const fs::path prefix = sdk_prefix();
    const std::string where = prefix.empty() ? "" : " -DCMAKE_PREFIX_PATH=" + quoted(prefix.string());
    return fmt::format(
        "next\n"
        "  cd {}\n"
        "  cmake -B build{}\n"
        "  cmake --build build\n"
        "  pelorus run config.yaml --plugins build\n",
        quoted(project.folder.string()), where);
}

int make_new(const CommandLine& line) {
    Project project;
    project.kind = line.argument(0);
    project.name = line.argument(1);
    project.folder = (fs::path(line.value("dir", ".")) / project.name).lexically_normal();
    if (host::find_kind(project.kind) == nullptr) {
        const std::string near = nearest(project.kind, kind_names());
        throw Error(Exit::misuse, fmt::format("new: there is no kind '{}'; {}", project.kind,
                                              near.empty() ? "kinds: " + all_kinds() : "did you mean '" + near + "'?"));
    }
    const std::string problem = name_problem(project.name);
    if (!problem.empty()) throw Error(Exit::misuse, "new: " + problem);
    const std::vector<std::string> names = make_project(project);
    if (line.has("json")) {
        print_json({{"id", plugin_id(project)},
                    {"folder", project.folder.string()},
                    {"files", names},
                    {"sdk", sdk_prefix().string()}});
        return static_cast<int>(Exit::done);
    }
    std::string files;
    for (const std::string& file : names) files += (files.empty() ? "" : ", ") + file;
    print(fmt::format("{} in {}: {}\n{}", plugin_id(project), project.folder.string(), files, next_steps(project)));
    return static_cast<int>(Exit::done);
}

}  // namespace

Command new_command() {
    return {
        "new",
        "begin a plugin of your own",
        "Makes the folder NAME: a complete plugin project outside the Pelorus tree, with a small working model to "
        "change, a config that runs it and a README. It becomes NAME.so with the id org.example.KIND.NAME, which is "
        "yours to change.\n\nKinds: " +
            all_kinds() +
            ".\n\nThe models to begin with: motion: straight with drag, in space; sensor: range and azimuth, in the "
            "plane; estimator: an extended Kalman filter that forgets; extent: an ellipsoid from the scatter; "
            "partitioner: chains of near measurements; waveform: effort shared between range and angle; trajectory: "
            "a level circle; source: a target on a line; registration, fusion: scans with corrected stamps; "
            "tracker: one track by the nearest measurement; scheduler: a look at the least certain track; analyzer: "
            "measurements a scan; sink: a line a track and time.",
        {{"KIND", "NAME"},
         {{"dir", "DIR", "make the folder there instead of here"}, {"json", "", "what was made, as JSON"}},
         {}},
        {{"pelorus new motion drag", "a motion model in ./drag"},
         {"pelorus new tracker nearest --dir /tmp", "a tracker in /tmp/nearest"}},
        &make_new};
}

}  // namespace pelorus::cli
