// Every kind of project that `pelorus new` makes: built out of tree against the installed SDK alone, put into a plugin folder,
// run by a config that names it, while the host stays what it was; and the conformance suites find nothing wrong with it.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../support/process.hpp"
#include "project_build.hpp"

using namespace pelorus::test;
using Catch::Contains;

namespace {

/// A figure of the run that shows the plugin at work, and between what it lies if it works.
struct Figure {
    std::string name;
    double least, most;
};

double value_of(const ProjectBuild& project, const std::string& name) {
    const auto summary = nlohmann::json::parse(read_file(project.results() / "summary.json"));
    return summary["cells"][0]["scalars"].at(name)["value"].get<double>();
}

bool provenance_names(const ProjectBuild& project, const std::string& id) {
    const auto provenance = nlohmann::json::parse(read_file(project.results() / "provenance.json"));
    for (const auto& plugin : provenance["plugins"])
        if (plugin["id"] == id) return provenance["completed"] == true;
    return false;
}

void check_conformance(const ProjectBuild& project) {
    const Ended listed = run({"ctest", "--test-dir", (project.folder() / "build").string(), "-N"});
    CHECK(count(listed.out, ": conformance: ") > 20);
    std::vector<std::string> words{"conform", (project.plugins() / "mine.so").string(), "--quiet"};
    const auto subjects = project.folder() / "conformance.yaml";
    if (std::filesystem::exists(subjects)) words.push_back("--subjects=" + subjects.string());
    const Ended ended = pelorus_command(words);
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 0);
}

ProjectBuild check_kind(const std::string& kind, const Figure& figure) {
    const std::string id = "org.example." + kind + ".mine", host_before = host_sha256();
    const ProjectBuild project(kind, "mine");
    project.build();
    const Ended ended = project.run_config();
    CAPTURE(ended.out, ended.err);
    REQUIRE(ended.exit == 0);
    CHECK_THAT(ended.err, !Contains("warning") && !Contains("error"));
    CHECK(provenance_names(project, id));
    if (!figure.name.empty()) {
        CHECK(value_of(project, figure.name) >= figure.least);
        CHECK(value_of(project, figure.name) <= figure.most);
    }
    CHECK(host_sha256() == host_before);
    check_conformance(project);

    const Ended inspected = pelorus_command({"inspect", id, "--plugins", project.plugins().string()});
    CHECK(inspected.exit == 0);
    CHECK_THAT(inspected.out, Contains("\npurpose\n"));

    const auto schema = project.folder() / "schema.json";
    REQUIRE(pelorus_command({"schema", "--plugins", project.plugins().string(), "--out", schema.string()}).exit == 0);
    const Ended valid = validate_configs(schema, {(project.folder() / "config.yaml").string()});
    CAPTURE(valid.out, valid.err);
    CHECK(valid.exit == 0);
    return project;
}

// Sensor noise in these configs is 10 m on each axis (5 m in the source's).
const Figure tracked = {"errors.position_rmse", 0.1, 15};
const Figure passed = {"clock.passed", 100, 100};

}  // namespace

// The plugins are not instrumented, whatever the host is.
TEST_CASE("new motion: builds out of tree and runs", "[release-only]") { check_kind("motion", tracked); }
TEST_CASE("new sensor: builds out of tree and runs", "[release-only]") {
    const ProjectBuild project = check_kind("sensor", tracked);
    // What is sampled is not among the levels that are tried unless asked for.
    const Ended sampled = pelorus_command({"conform", (project.plugins() / "mine.so").string(), "--level=5", "--quiet",
                                           "--only=sensor-inverse-is-consistent", "--only=sensor-inverse-is-unbiased"});
    CAPTURE(sampled.out, sampled.err);
    CHECK(sampled.exit == 0);
}
TEST_CASE("new estimator: builds out of tree and runs", "[release-only]") { check_kind("estimator", tracked); }
TEST_CASE("new extent: builds out of tree and runs", "[release-only]") {
    check_kind("extent", {"shape.major_axis_error", 0.01, 1});
}
TEST_CASE("new partitioner: builds out of tree and runs", "[release-only]") {
    check_kind("partitioner", {"cells.mean_cells", 1.5, 2.5});
}
TEST_CASE("new waveform: builds out of tree and runs", "[release-only]") {
    check_kind("waveform", {"scheduler.mean_choice", 0.11, 0.89});
}
TEST_CASE("new trajectory: builds out of tree and runs", "[release-only]") {
    check_kind("trajectory", {"errors.position_rmse", 0.1, 20});
}
TEST_CASE("new source: builds out of tree and runs", "[release-only]") { check_kind("source", tracked); }
TEST_CASE("new registration: builds out of tree and runs", "[release-only]") { check_kind("registration", passed); }
TEST_CASE("new fusion: builds out of tree and runs", "[release-only]") { check_kind("fusion", passed); }
TEST_CASE("new tracker: builds out of tree and runs", "[release-only]") { check_kind("tracker", tracked); }
TEST_CASE("new scheduler: builds out of tree and runs", "[release-only]") {
    check_kind("scheduler", {"scheduler.commands", 90, 100});
}
TEST_CASE("new analyzer: builds out of tree and runs", "[release-only]") {
    check_kind("analyzer", {"count.mean_count", 0.6, 0.95});
}
TEST_CASE("new sink: builds out of tree and runs", "[release-only]") {
    const ProjectBuild project = check_kind("sink", {"", 0, 0});
    CHECK(count(read_file(project.results() / "mine.txt"), "\n") > 90);
}
