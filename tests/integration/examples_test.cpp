// The examples of the SDK, as their authors' projects: built from nothing out of what is installed, tested by their own tests,
// looked at by the command, refused where their ABI is another one.
#include <catch2/catch.hpp>
#include <dlfcn.h>
#include <nlohmann/json.hpp>
#include <pelorus/abi/abi.h>

#include <fstream>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"
#include "project_build.hpp"

using namespace pelorus::test;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

const fs::path installed_examples = PELORUS_SDK_INSTALL "/share/pelorus/examples";
const fs::path built_examples = PELORUS_PLUGIN_DIR "/examples";

/// Builds of projects by cmake/build_example.cmake, which the build of this tree uses. Their place is always the same, so that
/// ccache knows it.
class ExampleBuilds {
public:
    ExampleBuilds(const std::string& name, const fs::path& sdk) : root_(PELORUS_BUILD_DIR "/tests/examples/" + name) {
        fs::remove_all(root_);
        fs::create_directories(root_ / "sources");
        std::ofstream(settings_) << "set(SDK \"" << sdk.string() << "\")\nset(BUILDS \"" << (root_ / "builds").string()
                                 << "\")\nset(PLUGINS \"" << plugins().string()
                                 << "\")\nset(BUILD_TYPE Release)\nset(LAUNCHER \""
                                 << (run({"sh", "-c", "command -v ccache"}).exit == 0 ? "ccache" : "") << "\")\n";
    }

    fs::path source(const std::string& example) const { return root_ / "sources" / example; }
    fs::path folder(const std::string& example) const { return root_ / "builds" / example; }
    fs::path stamp() const { return root_ / "built"; }
    fs::path plugins() const { return root_ / "plugins"; }

    /// A copy of the sources as installed.
    void take(const std::string& example) const {
        fs::copy(installed_examples / example, source(example), fs::copy_options::recursive);
    }
    Ended build(const std::string& example) const {
        return run({"cmake", "-DSETTINGS=" + settings_.string(), "-DSOURCE=" + source(example).string(),
                    "-DSTAMP=" + stamp().string(), "-P", PELORUS_SOURCE_DIR "/cmake/build_example.cmake"});
    }

private:
    fs::path root_, settings_ = root_ / "settings.cmake";
};

/// The installed SDK, but of the next major.
fs::path sdk_of_next_major(const std::string& for_whom) {
    const fs::path sdk = PELORUS_BUILD_DIR "/tests/examples/sdk-of-next-major-" + for_whom;
    fs::remove_all(sdk);
    fs::copy(PELORUS_SDK_INSTALL, sdk, fs::copy_options::recursive);
    const fs::path header = sdk / "include/pelorus/abi/threads.h";
    std::string text = read_file(header);
    const std::string now = "#define PLR_ABI_MAJOR " + std::to_string(PLR_ABI_MAJOR);
    REQUIRE(count(text, now) == 1);
    text.replace(text.find(now), now.size(), "#define PLR_ABI_MAJOR " + std::to_string(PLR_ABI_MAJOR + 1));
    std::ofstream(header) << text;
    return sdk;
}

/// The entry point of a library, which stays loaded.
const plr_entry_point& entry_of(const fs::path& library) {
    void* const handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    INFO((handle == nullptr ? dlerror() : ""));
    REQUIRE(handle != nullptr);
    const auto* const entry = static_cast<const plr_entry_point*>(dlsym(handle, PLR_ENTRY_SYMBOL));
    REQUIRE(entry != nullptr);
    return *entry;
}

void check_example(const std::string& example, const std::string& id, const std::string& library) {
    const std::string host_before = host_sha256();
    const ExampleBuilds own(example, PELORUS_SDK_INSTALL);
    own.take(example);
    const Ended built = own.build(example);
    CAPTURE(built.out, built.err);
    REQUIRE(built.exit == 0);
    REQUIRE(fs::exists(own.stamp()));
    const std::string rules = read_file(own.folder(example) / "build.ninja");
    CHECK(count(rules, PELORUS_SDK_INSTALL "/include") > 0);
    CHECK(count(rules, PELORUS_SOURCE_DIR "/sdk") + count(rules, PELORUS_SOURCE_DIR "/framework") == 0);
    const Ended tested =
        run({"ctest", "--test-dir", own.folder(example).string(), "--output-on-failure", "--no-tests=error"});
    CAPTURE(tested.out);
    CHECK(tested.exit == 0);
    CHECK(count(tested.out, ": conformance: ") > 0);

    const fs::path file = own.plugins() / example / library;
    const Ended symbols = run({"nm", "-D", "--defined-only", "--format=posix", file.string()});
    CHECK(count(symbols.out, "\n") == 1);
    CHECK_THAT(symbols.out, Catch::StartsWith("plr_entry "));
    CHECK(entry_of(file).abi_major == PLR_ABI_MAJOR);
    CHECK(entry_of(file).factory("org.example.nothing") == nullptr);

    // The build tree has a build of its own, which gives way.
    const Ended inspected = pelorus_command({"inspect", id, "--json", "--plugins", own.plugins().string()});
    REQUIRE(inspected.exit == 0);
    const auto plugin = nlohmann::json::parse(inspected.out);
    CHECK(plugin["library"] == fs::canonical(file).string());
    for (const char* told : {"title", "purpose", "equation", "license"})
        CHECK(!plugin[told].get<std::string>().empty());
    for (const auto& parameter : plugin["parameters"]) CHECK(!parameter["doc"].get<std::string>().empty());
    CHECK_THAT(pelorus_command({"inspect", file.string()}).out, Contains(id) && Contains("\npurpose\n"));
    CHECK_THAT(read_file(own.source(example) / "README.md"), Catch::StartsWith("# " + id + "\n"));

    const ExampleBuilds next(example + "-next-major", sdk_of_next_major(example));
    next.take(example);
    REQUIRE(next.build(example).exit == 0);
    CHECK(entry_of(next.plugins() / example / library).abi_major == PLR_ABI_MAJOR + 1);
    const Ended refused = pelorus_command({"inspect", id, "--plugins", next.plugins().string()});
    CHECK(refused.exit == 2);
    CHECK_THAT(refused.err, Contains("plugin " + id + " speaks ABI " + std::to_string(PLR_ABI_MAJOR + 1)));
    CHECK(host_sha256() == host_before);
}

}  // namespace

TEST_CASE("example: a motion model in C++ builds from nothing and keeps its own laws", "[release-only]") {
    check_example("coordinated_turn_motion", "org.example.motion.coordinated_turn", "motion/coordinated_turn.so");
}
TEST_CASE("example: a partitioner in C11 builds from nothing and splits as every pair says", "[release-only]") {
    check_example("distance_partitioner", "org.example.partitioner.distance", "partitioner/distance_partitioner.so");
}
TEST_CASE("example: a sensor in Fortran builds from nothing and measures as trigonometry says", "[release-only]") {
    check_example("bearing_sensor_fortran", "org.example.sensor.bearing", "sensor/bearing.so");
}
TEST_CASE("example: a stage with state builds from nothing and knows inside from outside", "[release-only]") {
    check_example("zone_alarm_stage", "org.example.analyzer.zone_alarm", "analyzer/zone_alarm.so");
}
TEST_CASE("example: a motion of clang with libc++ builds from nothing, and needs no libstdc++", "[release-only]") {
    check_example("libcxx_motion", "org.example.motion.mean_reverting", "motion/mean_reverting.so");
    const Ended needed = run({"readelf", "-d", (built_examples / "libcxx_motion/motion/mean_reverting.so").string()});
    CHECK_THAT(needed.out, Contains("libc++.so") && !Contains("libstdc++.so"));
}

TEST_CASE("examples: one whose compiler is not there is left out, one that does not compile is an error",
          "[release-only]") {
    const ExampleBuilds builds("left-out", PELORUS_SDK_INSTALL);
    builds.take("libcxx_motion");
    std::ofstream(builds.source("libcxx_motion") / "toolchain.cmake") << "set(CMAKE_CXX_COMPILER no-such-compiler)\n";
    const Ended left_out = builds.build("libcxx_motion");
    CHECK(left_out.exit == 0);
    CHECK_THAT(left_out.out, Contains("libcxx_motion is left out: it needs no-such-compiler"));
    CHECK(!fs::exists(builds.stamp()));

    builds.take("distance_partitioner");
    std::ofstream(builds.source("distance_partitioner") / "distance_partitioner.c", std::ios::app) << "#error broken\n";
    const Ended broken = builds.build("distance_partitioner");
    CHECK(broken.exit == 1);
    CHECK_THAT(broken.err, Contains("distance_partitioner cannot be built") && Contains("#error broken"));
    CHECK(!fs::exists(builds.stamp()));
}

TEST_CASE("examples: their sources and configs come with the SDK, their plugins are not installed with the host",
          "[release-only]") {
    const TemporaryFolder folder;
    REQUIRE(run({"cmake", "--install", PELORUS_BUILD_DIR, "--component", "host", "--prefix", folder / "host"}).exit ==
            0);
    const Ended listed = run({folder / "host/bin/pelorus", "list", "--json"});
    REQUIRE(listed.exit == 0);
    CHECK_THAT(listed.out, Contains("motion.singer") && !Contains("org.example"));
    CHECK(!fs::exists(folder.path() / "host/lib/pelorus/examples"));
    CHECK_THAT(read_file(folder / "host/share/pelorus/config.schema.json"), !Contains("org.example"));

    std::size_t projects = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(PELORUS_SOURCE_DIR "/sdk/examples")) {
        CAPTURE(entry.path());
        ++projects;
        CHECK(fs::exists(installed_examples / entry.path().filename() / "README.md"));
        CHECK(!fs::exists(installed_examples / entry.path().filename() / "build"));
        CHECK(fs::exists(built_examples / entry.path().filename()));
    }
    CHECK(projects == 5);
    CHECK(fs::exists(installed_examples / "example_zone_alarm.yaml"));
    CHECK(fs::exists(installed_examples / "example_distance_partitioner.yaml"));
}
