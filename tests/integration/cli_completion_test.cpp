// Completion in bash, and the manual page: both are made from the commands' own descriptions.
#include <algorithm>
#include <catch2/catch.hpp>
#include <sstream>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

using Words = std::vector<std::string>;

/// What bash offers for the last word of a line, which is split as bash does.
Words completed(const Words& line, const std::string& folder = ".") {
    std::string script = "source '" PELORUS_BUILD_DIR "/share/bash-completion/completions/pelorus'\nCOMP_WORDS=(";
    for (const std::string& word : line) script += " '" + word + "'";
    script += " )\nCOMP_CWORD=" + std::to_string(line.size() - 1) +
              "\n_pelorus\n((${#COMPREPLY[@]})) && printf '%s\\n' \"${COMPREPLY[@]}\"\ntrue\n";
    ProcessOptions options;
    options.folder = folder;
    options.environment = {{"PELORUS_PLUGIN_PATH", ""}};
    const Ended ended = run({"bash", "-c", script}, options);
    CAPTURE(line, ended.err);
    CHECK(ended.exit == 0);
    CHECK(ended.err.empty());
    Words words;
    std::istringstream lines(ended.out);
    for (std::string word; std::getline(lines, word);) words.push_back(word);
    return words;
}

const std::string command = PELORUS_EXECUTABLE;

bool has(const Words& words, const std::string& word) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

TEST_CASE("bash completes commands, flags, kinds, levels and ids") {
    CHECK(completed({command, "in"}) == Words{"inspect"});
    CHECK(completed({command, "c"}) == Words{"compare", "check", "conform", "completion"});
    CHECK(has(completed({command, ""}), "run"));
    CHECK(completed({command, "help", "sch"}) == Words{"schema"});
    CHECK(completed({command, "run", "c.yaml", "--s"}) ==
          Words{"--set", "--seed", "--snapshot-at", "--stop-at-snapshot"});
    CHECK_FALSE(has(completed({command, "run", "c.yaml", "--seed", "1", "--s"}), "--seed"));
    CHECK(completed({command, "list", "--kind", "mo"}) == Words{"motion"});
    CHECK(completed({command, "list", "--kind", "=", "mo"}) == Words{"motion"});
    CHECK(completed({command, "new", "tra"}) == Words{"trajectory", "tracker"});
    CHECK(completed({command, "run", "c.yaml", "--log-level", "w"}) == Words{"warning"});
    CHECK(completed({command, "run", "c.yaml", "--guard", ""}) == Words{"off", "start", "all"});
    CHECK(completed({command, "inspect", "motion.si"}) == Words{"motion.singer"});
    CHECK(completed({command, "completion", ""}) == Words{"bash"});
    CHECK(completed({command, "frobnicate", ""}).empty());
}

TEST_CASE("bash completes configs and folders") {
    const TemporaryFolder folder;
    folder.write("pipeline.yaml", "");
    folder.write("picture.png", "");
    std::filesystem::create_directory(folder.path() / "pipes");
    const std::string here = folder.path().string();
    CHECK(completed({command, "run", "pi"}, here) == Words{"pipeline.yaml", "pipes"});
    CHECK(completed({command, "run", "pipeline.yaml", "--out", "pi"}, here) == Words{"pipes"});
    CHECK(completed({command, "run", "pipeline.yaml", "--out", "="}, here) == Words{"pipes"});
    CHECK(completed({command, "schema", "--out", "pic"}, here) == Words{"picture.png"});
}

TEST_CASE("bash completes the addresses of the config after --set") {
    const std::string config = PELORUS_SOURCE_DIR "/configs/airship.yaml";
    CHECK(completed({command, "run", config, "--set", "tracker.estimator.motion.f"}) ==
          Words{"tracker.estimator.motion.form="});
    CHECK(has(completed({command, "check", config, "--set", "world.sensors.radar.d"}), "world.sensors.radar.drop="));
    CHECK(completed({command, "run", config, "--set", "world.scans", "=", "5"}).empty());
    CHECK(completed({command, "run", config, "--set", "world.scans", "=", "5", "--thr"}) == Words{"--threads"});
    CHECK(completed({command, "run", "nowhere.yaml", "--set", "world."}).empty());
}

TEST_CASE("bash completes the variants of the config, and any number of folders to be merged") {
    const TemporaryFolder folder;
    const std::string here = folder.path().string();
    folder.write("c.yaml", "pelorus: 1\ncampaign: {variants: {calm: {}, lively: {}}}\n");
    std::filesystem::create_directory(folder.path() / "part1");
    CHECK(completed({command, "run", "c.yaml", "--variant", "l"}, here) == Words{"lively"});
    CHECK(completed({command, "merge", "part1", "pa"}, here) == Words{"part1"});
}

TEST_CASE("the manual page has every command and flag, and no fault that mandoc finds") {
    const std::string file = PELORUS_BUILD_DIR "/share/man/man1/pelorus.1";
    CHECK(read_file(file) == pelorus_command({"help", "--man"}).out);
    const Ended lint = run({"mandoc", "-Tlint", "-Wwarning", file});
    CAPTURE(lint.out, lint.err);
    CHECK(count(lint.out, "\n") == 1);
    CHECK_THAT(lint.out, Contains("missing date"));  // so that two builds make the same page
    const Ended page = run({"mandoc", "-Tascii", "-Owidth=200", file});
    CHECK(page.exit == 0);
    std::string text;  // without overstriking
    for (const char c : page.out)
        if (c == '\b')
            text.pop_back();
        else
            text += c;
    for (const char* word :
         {"pelorus run CONFIG", "--snapshot-at TIME", "pelorus inspect ID|LIB.so|CONFIG",
          "--set 'tracker.estimator.motion=~'", "EXIT STATUS", "PELORUS_PLUGIN_PATH", "runs tracking pipelines"})
        CHECK_THAT(text, Contains(word));
}
