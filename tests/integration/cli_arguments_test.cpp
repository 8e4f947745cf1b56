// The command line: what is understood, what is refused, and where the words go.
#include <catch2/catch.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Catch::Contains;
using Catch::StartsWith;

namespace {

/// Refused before anything is done: exit 2, one line, nothing on standard output.
void check_refused(const std::vector<std::string>& arguments, const std::string& expected) {
    CAPTURE(arguments);
    const Ended ended = pelorus_command(arguments);
    CHECK(ended.exit == 2);
    CHECK(ended.out.empty());
    CHECK(count(ended.err, "\n") == 1);
    CHECK_THAT(ended.err, StartsWith("pelorus: ") && Contains(expected));
}

}  // namespace

TEST_CASE("help and version go to standard output") {
    for (const std::string flag : {"--help", "-h", "help"}) {
        const Ended ended = pelorus_command({flag});
        CHECK(ended.exit == 0);
        CHECK(ended.err.empty());
        for (const char* word : {"run CONFIG", "check CONFIG", "list", "inspect ID|LIB.so|CONFIG", "new KIND NAME",
                                 "schema", "completion SHELL", "exit codes", "PELORUS_PLUGIN_PATH", "PELORUS_DATA"})
            CHECK_THAT(ended.out, Contains(word));
    }
    const Ended version = pelorus_command({"--version"});
    CHECK(version.exit == 0);
    CHECK_THAT(version.out, StartsWith("pelorus " PELORUS_VERSION));
}

TEST_CASE("every command teaches itself, with flags and examples") {
    for (const std::string command : {"run", "check", "list", "inspect", "new", "schema", "completion"}) {
        CAPTURE(command);
        const Ended page = pelorus_command({"help", command});
        CHECK(page.exit == 0);
        for (const char* part : {"usage: pelorus ", "\nflags\n", "\nexamples\n", "\nexit codes\n"})
            CHECK_THAT(page.out, Contains(part));
        CHECK(pelorus_command({command, "--help"}).out == page.out);
    }
    for (const char* flag : {"--out DIR", "--set ADDRESS=VALUE", "--seed N", "--threads N", "--plugins DIR",
                             "--snapshot-at TIME", "--stop-at-snapshot", "--resume DIR", "--log-level LEVEL"})
        CHECK_THAT(pelorus_command({"help", "run"}).out, Contains(flag));
}

TEST_CASE("without a command the overview goes to standard error, exit 2") {
    const Ended ended = pelorus_command({});
    CHECK(ended.exit == 2);
    CHECK(ended.out.empty());
    CHECK_THAT(ended.err, Contains("usage: pelorus COMMAND"));
}

TEST_CASE("unknown commands and flags are refused with the nearest right one") {
    check_refused({"rum"}, "unknown command 'rum'; did you mean 'run'?");
    check_refused({"xyzzy"}, "see: pelorus --help");
    check_refused({"--frobnicate"}, "unknown flag '--frobnicate'");
    check_refused({"run", "c.yaml", "--thread", "2"}, "unknown flag --thread; did you mean --threads?");
    check_refused({"run", "c.yaml", "-x"}, "unknown flag -x");
    check_refused({"help", "inspekt"}, "did you mean 'inspect'?");
}

TEST_CASE("reports and comparisons are of folders that are named, in formats that there are") {
    check_refused({"report"}, "DIR is missing; usage: pelorus report DIR");
    check_refused({"report", "x", "--plot", "pdf"}, "--plot: expected png or svg, got 'pdf'");
    check_refused({"compare", "x", "y", "--plot", "png"}, "--plot: --html FILE is missing");
    check_refused({"compare", "x"}, "B is missing; usage: pelorus compare A B");
}

TEST_CASE("flags of campaigns that do not go together or mean nothing are refused") {
    check_refused({"run", "c.yaml", "--runs", "0"}, "--runs: expected a whole number from 1 to 1000000000, got '0'");
    check_refused({"run", "c.yaml", "--cell", "3"}, "--cell: --run R is missing");
    check_refused({"run", "c.yaml", "--run", "3", "--runs", "4"}, "--run: one run alone has no --runs");
    check_refused({"run", "c.yaml", "--run", "3", "--cells", "1/2"}, "--run: one run alone has no --cells");
    for (const std::string part : {"0/2", "3/2", "1", "1/", "/2", "a/2", "1/2/3"})
        check_refused({"run", "c.yaml", "--cells", part}, "--cells: expected I/N");
    check_refused({"merge"}, "DIR is missing; usage: pelorus merge DIR...");
    check_refused({"merge", "part"}, "merge: --out DIR is missing");
}

TEST_CASE("arguments that are missing, superfluous or malformed are refused") {
    check_refused({"conform"}, "LIB.so is missing");
    check_refused({"conform", "--list", "x.so"}, "unexpected argument 'x.so'");
    check_refused({"run"}, "CONFIG is missing");
    check_refused({"run", "a.yaml", "b.yaml"}, "unexpected argument 'b.yaml'");
    check_refused({"run", "a.yaml", "--out"}, "--out");
    check_refused({"run", "a.yaml", "--out", "x", "--out", "y"}, "--out is given more than once");
    check_refused({"run", "a.yaml", "--seed", "-1"}, "--seed: expected a whole number");
    check_refused({"run", "a.yaml", "--seed", "1.5"}, "got '1.5'");
    check_refused({"run", "a.yaml", "--seed", "99999999999999999999"}, "--seed: expected a whole number");
    check_refused({"run", "a.yaml", "--threads", "many"}, "--threads: expected a whole number");
    check_refused({"run", "a.yaml", "--set", "noise"}, "--set: expected ADDRESS=VALUE");
    check_refused({"run", "a.yaml", "--set", "=3"}, "--set: expected ADDRESS=VALUE");
    check_refused({"run", "a.yaml", "--snapshot-at", "5 parsecs"}, "--snapshot-at");
    check_refused({"run", "a.yaml", "--stop-at-snapshot"}, "--snapshot-at TIME is missing");
    check_refused({"run", "a.yaml", "--plugins", "/nonexistent"}, "/nonexistent is no folder");
    check_refused({"run", "a.yaml", "--log-level", "loud"}, "no log level loud");
    check_refused({"list", "--kind", "motoin"}, "did you mean 'motion'?");
    check_refused({"inspect", "motion.singerr"}, "motion.singer");
    check_refused({"new", "motoin", "x"}, "did you mean 'motion'?");
}

TEST_CASE("a config that is not there is told by its name") {
    const Ended ended = pelorus_command({"run", "nothere.yaml"});
    CHECK(ended.exit == 2);
    CHECK_THAT(ended.err, StartsWith("nothere.yaml: "));
}

TEST_CASE("a reader that has gone ends the command quietly") {
    ProcessOptions options;
    options.close_output = true;
    const Ended ended = pelorus_command({"--help"}, options);
    CHECK(ended.exit == 1);
    CHECK(ended.err.empty());
}

TEST_CASE("a full or closed standard output is an error and says so") {
    const std::string command = PELORUS_EXECUTABLE;
    const Ended full = run({"sh", "-c", command + " --help >/dev/full"});
    CHECK(full.exit == 1);
    CHECK_THAT(full.err, Contains("cannot write to standard output: No space left on device"));
    const Ended closed = run({"sh", "-c", command + " --help >&-"});
    CHECK(closed.exit == 1);
    CHECK_THAT(closed.err, Contains("cannot write to standard output"));
}

TEST_CASE("plugins are listed by kind, as text and as JSON") {
    const Ended text = pelorus_command({"list"});
    CHECK(text.exit == 0);
    CHECK_THAT(text.out, Contains("motion\n") && Contains("  motion.singer  ") && Contains("estimator.kalman"));
    const Ended motions = pelorus_command({"list", "--kind", "motion"});
    CHECK_THAT(motions.out, StartsWith("motion\n") && !Contains("estimator.kalman"));
    CHECK(pelorus_command({"list", "--kind", "motion", "--json"}).out.find("\"id\": \"motion.singer\"") !=
          std::string::npos);
}

TEST_CASE("libraries that cannot be used are told with the reason, and the others listed") {
    const TemporaryFolder folder;
    folder.write("rubbish.so", "no library at all");
    const Ended ended = pelorus_command({"list", "--plugins", folder.path().string()});
    CHECK(ended.exit == 0);
    CHECK_THAT(ended.err, Contains("not used: ") && Contains("rubbish.so"));
    CHECK_THAT(ended.out, Contains("motion.singer"));
}

TEST_CASE("inspect lays out a plugin: spaces, parameters, slots and ports") {
    const Ended singer = pelorus_command({"inspect", "motion.singer"});
    CHECK(singer.exit == 0);
    for (const char* part : {"\npurpose\n", "\nequation\n", "\nsource\n", "\nstate space\n", "acceleration.z",
                             "\nparameters\n", "maneuver_rate: ", "truncated"})
        CHECK_THAT(singer.out, Contains(part));
    const Ended kalman = pelorus_command({"inspect", "estimator.kalman"});
    CHECK_THAT(kalman.out, Contains("\nslots\n") && Contains("motion: kind motion") && Contains("depend on its parts"));
    const Ended tracker = pelorus_command({"inspect", "tracker.point_target"});
    CHECK_THAT(tracker.out, Contains("\nin ports\n") && Contains("\nout ports\n"));
    CHECK_THAT(pelorus_command({"inspect", "motion.singer", "--json"}).out, StartsWith("{\n"));
}
