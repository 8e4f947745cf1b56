// What sinks promise of the files that they leave.
#include <unistd.h>

#include <cstring>
#include <fstream>

#include "machine/message_fields.hpp"
#include "machine/stage_bench.hpp"

namespace pelorus::conformance {

namespace fs = std::filesystem;

namespace {

/// A working directory of its own while it lives.
class WorkingFolder {
public:
    WorkingFolder() : before_(fs::current_path()) { fs::current_path(folder_.path()); }
    ~WorkingFolder() {
        std::error_code ignored;
        fs::current_path(before_, ignored);
    }
    WorkingFolder(const WorkingFolder&) = delete;
    WorkingFolder& operator=(const WorkingFolder&) = delete;
    std::map<std::string, std::string> contents() const { return folder_.contents(); }

private:
    TemporaryFolder folder_;
    fs::path before_;
};

std::string names(const std::map<std::string, std::string>& files) {
    std::string text;
    for (const auto& [name, content] : files) text += (text.empty() ? "" : ", ") + name;
    return text;
}

}  // namespace

PELORUS_CHECK(sink, "sink-writes-nothing-early", 3,
              "A sink touches no file before its first message: `pelorus check` makes every node of a graph and must "
              "leave nothing behind.",
              {"stage-takes-what-it-asks-for"}) {
    const WorkingFolder here;
    StagePlayer player(bench);
    for (std::uint32_t port = 0; port < player.instance().description().in_port_count; ++port)
        port_type_of(player.instance(), false, port);
    if (!player.files().empty())
        FAIL("before the first message there is, in the result folder: " << names(player.files()));
    player.destroy();
    if (!player.files().empty())
        FAIL("without any message the sink leaves, in the result folder: " << names(player.files()));
    if (!here.contents().empty())
        FAIL("before the first message there is, in the working directory: " << names(here.contents()));
}

PELORUS_CHECK(sink, "sink-writes-where-it-is-told", 3,
              "Files of relative names lie in the result folder, and nothing lies elsewhere: not in the working "
              "directory, which may be anybody's.",
              {"stage-takes-what-it-asks-for"}) {
    const Script script = plain_script(bench);
    const WorkingFolder here;
    StagePlayer player(bench);
    play(player, script);
    player.finish_well();
    player.destroy();
    if (!here.contents().empty()) FAIL("the sink wrote into the working directory: " << names(here.contents()));
    note(std::to_string(player.files().size()) + " files in the result folder");
}

PELORUS_CHECK(sink, "sink-files-are-complete", 3,
              "Once finish has returned, the files are as they will stay; whoever reads the results does not wait for "
              "the end of the process.",
              {"stage-takes-what-it-asks-for"}) {
    const Script script = plain_script(bench);
    StagePlayer player(bench);
    play(player, script);
    player.finish_well();
    Trace finished;
    finished.files = player.files();
    player.destroy();
    Trace destroyed;
    destroyed.files = player.files();
    const std::string difference = difference_of(finished, destroyed);
    if (!difference.empty()) FAIL("after finish and after destroy, files differ: " << difference);
}

PELORUS_CHECK(
    sink, "sink-tells-what-it-cannot-write", 3,
    "A file that cannot be written is PLR_E_IO with its path, in receive or finish at the latest; results that "
    "vanish without a word are found out weeks later.",
    {"sink-files-are-complete"}) {
    const Script script = plain_script(bench);
    {
        StagePlayer well(bench);
        play(well, script);
        well.finish_well();
        if (well.files().empty()) skip("the sink writes no files into the result folder");
    }
    // A folder below a file cannot be made, not even by a superuser.
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "file";
    std::ofstream(file) << "in the way\n";
    PlayOptions options;
    options.folder = file / "results";
    StagePlayer player(bench, options);
    for (std::size_t i = 0; i <= script.deliveries.size(); ++i) {
        const bool is_last = i == script.deliveries.size();
        const Answer answer =
            is_last ? player.finish() : player.receive(script.deliveries[i].port, *script.deliveries[i].message);
        if (answer.is_ok() || answer.is_refusal()) continue;
        const char* const function = is_last ? "finish" : "receive";
        if (answer.status != PLR_E_IO)
            FAIL(function << " answered " << answer.told << " where the file cannot be written, expected PLR_E_IO");
        if (answer.told.find(options.folder.string()) == std::string::npos)
            FAIL(function << " answered " << answer.told << "; the message lacks the path, which begins with "
                          << options.folder.string());
        return;
    }
    FAIL("the result folder " << options.folder.string() << " cannot be made, and neither receive nor finish said so");
}

}  // namespace pelorus::conformance
