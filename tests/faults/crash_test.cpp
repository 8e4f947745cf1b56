// Plugins that end the process: one line still says where, and the exit code is 1.
#include <catch2/catch.hpp>

#include "guard_config.hpp"

using namespace pelorus::test;

namespace {

#ifdef PELORUS_ADDRESS_SANITIZER
constexpr bool sanitized = true;  // the sanitizer tells SIGSEGV itself, at length
#else
constexpr bool sanitized = false;
#endif

/// Under the sanitizer, leaves SIGSEGV to the command, as in a build without.
ProcessOptions plain() {
    ProcessOptions options;
    if (sanitized) options.environment["ASAN_OPTIONS"] = "handle_segv=0:handle_sigbus=0:detect_leaks=0";
    return options;
}

Ended crash(const TemporaryFolder& folder, const ZooConfig& config) { return run_zoo(folder, config, {}, plain()); }

struct Case {
    const char* fault;
    const char* told;
};

}  // namespace

TEST_CASE("crash: a motion that ends the process leaves a line with node, call, part and folder") {
    const auto one = GENERATE(values<Case>({{"segfault", "SIGSEGV"},
                                            {"overflow", "SIGSEGV, stack overflow"},
                                            {"abort", "SIGABRT"},
                                            {"terminate", "SIGABRT, exception: nobody caught this"}}));
    CAPTURE(one.fault);
    const TemporaryFolder folder;
    ZooConfig config;
    config.motion = zoo_part("motion", one.fault, "propagate");
    const Ended ended = crash(folder, config);
    CHECK(ended.exit == 1);
    CHECK(ended.err == "pelorus: node tracker (tracker.point_target), receive scans at 1 s: crashed (" +
                           std::string(one.told) +
                           ") in propagate of tracker.estimator.motion (org.example.motion.zoo); incomplete files in " +
                           folder / "out" + ": truth.csv.part\n");
    CHECK(folder.has("out/truth.csv.part"));
}

TEST_CASE("crash: a stage that ends the process is named with its call") {
    const TemporaryFolder folder;
    ZooConfig config;
    config.further =
        "  zoo:\n    use: org.example.analyzer.zoo\n    in: {scans: world.scans}\n    with: {fault: abort, call: "
        "receive}\n";
    const Ended ended = crash(folder, config);
    CHECK(ended.exit == 1);
    CHECK(first_line(ended.err) ==
          "pelorus: node zoo (org.example.analyzer.zoo), receive scans at 0 s: crashed (SIGABRT) in "
          "org.example.analyzer.zoo; "
          "incomplete files in " +
              folder / "out" + ": truth.csv.part");
}

TEST_CASE("crash: a stage that ends the process, or throws, when it is asked what its ports carry is named") {
    const TemporaryFolder folder;
    const auto asked = [&](const std::string& fault) {
        ZooConfig config;
        config.further =
            "  zoo:\n    use: org.example.analyzer.zoo\n    in: {scans: world.scans}\n    with: {fault: " + fault +
            ", call: port_type}\n";
        return crash(folder, config);
    };
    const Ended crashed = asked("abort");
    CHECK(crashed.exit == 1);
    CHECK(crashed.err == "pelorus: crashed (SIGABRT) in port_type of zoo (org.example.analyzer.zoo)\n");
    const Ended thrown = asked("throws");
    CHECK(thrown.exit == 2);
    CHECK_THAT(first_line(thrown.err), Catch::EndsWith("zoo.scans: org.example.analyzer.zoo: boom"));
}

TEST_CASE("crash: a part that ends the process while it is made, asked or ended is named") {
    const std::string in = GENERATE("create", "info", "destroy");
    CAPTURE(in);
    const TemporaryFolder folder;
    ZooConfig config;
    config.motion = zoo_part("motion", "segfault", in);
    const Ended ended = crash(folder, config);
    CHECK(ended.exit == 1);
    const std::string line =
        "pelorus: crashed (SIGSEGV) in " + in + " of tracker.estimator.motion (org.example.motion.zoo)\n";
    CHECK(ended.err.size() >= line.size());
    CHECK_THAT(ended.err, Catch::EndsWith(line));
    CHECK(folder.has("out/summary.json") == (in == "destroy"));
}

TEST_CASE("crash: an exception through the C table of create is told like any problem of the config") {
    const TemporaryFolder folder;
    ZooConfig config;
    config.motion = zoo_part("motion", "throws", "create");
    const Ended ended = run_zoo(folder, config);
    CHECK(ended.exit == 2);
    CHECK_THAT(first_line(ended.err), Catch::EndsWith("tracker.estimator.motion: org.example.motion.zoo: boom"));
}

TEST_CASE("crash: a static constructor that throws or crashes names its library") {
    const TemporaryFolder folder;
    ZooConfig config;
    config.motion = "{use: org.example.motion.zoo_static}";
    const std::string library = std::filesystem::canonical(PELORUS_TEST_PLUGINS "/zoo_static.so").string();
    ProcessOptions options = plain();
    options.environment["PELORUS_ZOO_STATIC"] = "segfault";
    const Ended crashed = run_zoo(folder, config, {}, options);
    CHECK(crashed.exit == 1);
    CHECK(crashed.err == "pelorus: crashed (SIGSEGV) in loading of " + library + "\n");
    options.environment["PELORUS_ZOO_STATIC"] = "throws";
    // Nothing catches an exception on its way through the loader.
    const Ended thrown = run_zoo(folder, config, {}, options);
    CHECK(thrown.exit == 1);
    CHECK(thrown.err == "pelorus: crashed (SIGABRT, exception: boom) in loading of " + library + "\n");
    options.environment["PELORUS_ZOO_STATIC"] = "";
    CHECK(run_zoo(folder, config, {}, options).exit == 0);
}
