// Everything that can be done wrong with libpelorus: a status, a line, and nothing else.
#include <catch2/catch.hpp>
#include <pelorus/embed.hpp>

#include <map>
#include <thread>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Catch::Contains;
using pelorus::Pipeline;
using pelorus::PipelineOptions;

namespace {

const std::string config = PELORUS_SOURCE_DIR "/examples/embed/pipeline.yaml";

Pipeline opened(const PipelineOptions& options = {}) {
    auto pipeline = Pipeline::open(config, options);
    INFO(pipeline.status().text());
    REQUIRE(pipeline.ok());
    return std::move(*pipeline);
}

pelorus::Status failure_of_open(const std::string& text, const PipelineOptions& options = {}) {
    auto pipeline = Pipeline::open_text(text, "app.yaml", "/", options);
    REQUIRE_FALSE(pipeline.ok());
    return pipeline.status();
}

std::map<std::string, std::int64_t> counters(const Pipeline& pipeline, const std::string& node) {
    std::map<std::string, std::int64_t> found;
    for (const pelorus_diagnostic_info& one : pipeline.diagnostics())
        if (one.is_counter && node == one.node) found[one.name] = one.count;
    return found;
}

constexpr double plot[3] = {10e3, 0.5, 0.1};

}  // namespace

TEST_CASE("libpelorus: a refused config tells all that is wrong, a line each") {
    const pelorus::Status status = failure_of_open(
        "pelorus: 1\ngraph:\n  radar: {use: source.external, with: {lat: drop}}\n  sink: {use: sink.nothing}\n");
    CHECK(status.code() == PELORUS_E_CONFIG);
    CHECK_THAT(status.text(), Contains("app.yaml:3:") && Contains("lat") && Contains("did you mean 'late'?") &&
                                  Contains("\napp.yaml:4:") && Contains("no plugin sink.nothing"));

    plr_error error{};
    error.struct_size = sizeof error;
    pelorus_pipeline* pipeline = nullptr;
    CHECK(pelorus_open("/nowhere/at/all.yaml", nullptr, &pipeline, &error) == PELORUS_E_CONFIG);
    CHECK(error.code == PELORUS_E_CONFIG);
    CHECK(std::string(error.message) ==
          "/nowhere/at/all.yaml: there is no such file; there is no folder /nowhere/at either");
    CHECK(std::string(error.message) == pelorus_error_text());
    CHECK(pipeline == nullptr);
}

TEST_CASE("libpelorus: wrong options are told by name") {
    PipelineOptions options;
    options.overrides = {{"tracker.maximum_sped", "3 m/s"}};
    auto refused = Pipeline::open(config, options);
    CHECK(refused.status().code() == PELORUS_E_CONFIG);
    CHECK_THAT(refused.status().text(), Contains("tracker.maximum_sped") && Contains("maximum_speed"));
    options = {};
    options.plugin_folders = {"/nowhere/plugins"};
    CHECK_THAT(Pipeline::open(config, options).status().text(), Contains("/nowhere/plugins is no folder"));
    options = {};
    options.threads = 5000;
    CHECK_THAT(Pipeline::open(config, options).status().text(), Contains("options.threads is 5000"));
    options = {};
    options.result_folder = "/proc/nothing";
    CHECK(Pipeline::open(config, options).status().code() == PELORUS_E_FAILED);
    CHECK(pelorus_set_log(17, nullptr, nullptr, nullptr) == PLR_E_ARGUMENT);
}

TEST_CASE("libpelorus: NULL and structs that are too small are refused everywhere") {
    Pipeline pipeline = opened();
    pelorus_pipeline* const raw = pipeline.raw();
    plr_error small{};
    small.struct_size = 16;
    CHECK(pelorus_advance(raw, 0, &small) == PLR_E_ARGUMENT);
    CHECK_THAT(pelorus_error_text(), Contains("error.struct_size is 16"));
    pelorus_options options{};
    options.struct_size = 8;
    pelorus_pipeline* out = nullptr;
    CHECK(pelorus_open(config.c_str(), &options, &out, nullptr) == PLR_E_ARGUMENT);
    CHECK_THAT(pelorus_error_text(), Contains("options.struct_size is 8, expected at least"));
    CHECK(pelorus_open(nullptr, nullptr, &out, nullptr) == PLR_E_ARGUMENT);
    CHECK(std::string(pelorus_error_text()) == "file is NULL");
    CHECK(pelorus_open(config.c_str(), nullptr, nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(pelorus_open_text(nullptr, "a", "/", nullptr, &out, nullptr) == PLR_E_ARGUMENT);

    CHECK(pelorus_push(nullptr, "radar.scans", nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(std::string(pelorus_error_text()) == "pipeline is NULL");
    CHECK(pelorus_push(raw, "radar.scans", nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(pelorus_push(raw, nullptr, nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(pelorus_play(nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(pelorus_finish(nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(pelorus_now(raw, nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(pelorus_subscribe(raw, "tracker.tracks", nullptr, nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(pelorus_pull(nullptr, nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(pelorus_snapshot(raw, nullptr, nullptr) == PLR_E_ARGUMENT);
    CHECK(pelorus_restore(raw, nullptr, 0, nullptr) == PLR_E_ARGUMENT);
    pelorus_node_info node{};
    CHECK(pelorus_node(raw, 0, &node, nullptr) == PLR_E_ARGUMENT);
    CHECK_THAT(pelorus_error_text(), Contains("out.struct_size is 0"));
    node.struct_size = sizeof node;
    CHECK(pelorus_node(raw, 99, &node, nullptr) == PELORUS_E_NOT_FOUND);
    pelorus_close(nullptr);
    pelorus_unsubscribe(nullptr);
    pelorus_stop(nullptr);
}

TEST_CASE("libpelorus: a wrong scan is refused in one line and counted, and the pipeline goes on") {
    Pipeline pipeline = opened();
    const auto stream = pipeline.stream("radar.scans", "radar");
    REQUIRE(stream.ok());
    CHECK(pipeline.stream("radar.scans", "rader").status().code() == PELORUS_E_NOT_FOUND);
    plr_stream other = *stream;
    other.sensor = "sonar";
    pelorus::ScanMessage from_other(other);
    from_other.add(1, plot);
    pelorus::Status status = pipeline.push("radar.scans", from_other.message(0));
    CHECK(status.code() == PLR_E_ARGUMENT);
    CHECK_THAT(status.text(), Contains("radar.scans: the scan has sensor \"sonar\"") &&
                                  Contains("declared sensor \"radar\", frame \"\", space (range [m], azimuth [rad]"));
    other = *stream;
    other.frame = "site";
    pelorus::ScanMessage in_other_frame(other);
    CHECK_THAT(pipeline.push("radar.scans", in_other_frame.message(0)).text(), Contains("frame \"site\""));
    plr_space flat = *stream->space;
    flat.size = 2;
    other = *stream;
    other.space = &flat;
    pelorus::ScanMessage too_small(other);
    too_small.add(1, plot);
    CHECK(pipeline.push("radar.scans", too_small.message(0)).code() == PLR_E_ARGUMENT);

    pelorus::ScanMessage scan(*stream);
    const double broken[3] = {10e3, std::numeric_limits<double>::quiet_NaN(), 0};
    scan.add(1, plot);
    scan.add(2, broken);
    status = pipeline.push("radar.scans", scan.message(0));
    CHECK(status.code() == PLR_E_ARGUMENT);
    CHECK(status.item() == 1);
    CHECK_THAT(status.text(), Contains("scan.measurements[1] has nan at (1, 0)"));
    CHECK(counters(pipeline, "radar")["refused"] == 4);

    scan.clear();
    scan.add(1, plot);
    CHECK(pipeline.push("radar.scams", scan.message(0)).text() ==
          "there is no in port 'radar.scams'; did you mean 'radar.scans'?");
    CHECK(pipeline.push("tracker.scans", scan.message(0)).code() == PLR_E_ARGUMENT);
    CHECK(pipeline.subscribe("tracker.trucks").status().code() == PELORUS_E_NOT_FOUND);
    CHECK(pipeline.push("radar.truth", scan.message(0)).text() == "radar.truth: the port takes truth, not scan");
    CHECK(pipeline.push("radar.scans", scan.message(5'000'000'000)).ok());
    status = pipeline.push("radar.scans", scan.message(4'000'000'000));
    CHECK(status.code() == PELORUS_E_LATE);
    CHECK(status.text() == "radar.scans: the message arrives at 4 s, but the graph has come to 5 s");
    CHECK(counters(pipeline, "radar")["late_refused"] == 1);
    CHECK(pipeline.finish().ok());
    for (const pelorus::Status& after :
         {pipeline.push("radar.scans", scan.message(6'000'000'000)), pipeline.advance(0), pipeline.finish(),
          pipeline.snapshot().status(), pipeline.restore({1, 2, 3})}) {
        CHECK(after.code() == PELORUS_E_FINISHED);
        CHECK(after.text() == "the pipeline was finished");
    }
}

TEST_CASE("libpelorus: a plugin that fails breaks its pipeline, which says so from then on and keeps what there was") {
    const TemporaryFolder folder;
    PipelineOptions options;
    options.result_folder = folder / "out";
    options.overrides = {{"tracker.estimator.motion", "{use: org.example.motion.failing, with: {failure: exception}}"}};
    options.plugin_folders = {PELORUS_TEST_PLUGINS};
    Pipeline pipeline = opened(options);
    auto scans = pipeline.subscribe("radar.scans");
    pelorus::ScanMessage scan(*pipeline.stream("radar.scans", "radar"));
    pelorus::Status status;
    for (std::int64_t k = 0; status.ok() && k < 9; ++k) {
        scan.clear();
        scan.add(static_cast<std::uint64_t>(k), plot);
        status = pipeline.push("radar.scans", scan.message(k * 2'000'000'000));
        if (status.ok()) status = pipeline.advance(k * 2'000'000'000);
    }
    CHECK(status.code() == PELORUS_E_FAILED);
    CHECK_THAT(status.text(), Contains("node tracker (tracker.point_target)") && Contains("boom"));
    const pelorus::Status after = pipeline.advance(99'000'000'000);
    CHECK(after.code() == PELORUS_E_BROKEN);
    CHECK_THAT(after.text(), Contains("the pipeline failed before: node tracker"));
    CHECK(pipeline.finish().code() == PELORUS_E_BROKEN);
    CHECK(scans->pull() != nullptr);
    CHECK_FALSE(pipeline.diagnostics().empty());
    CHECK_THAT(folder.read("out/provenance.json"), Contains("\"completed\": false"));
}

TEST_CASE("libpelorus: the log goes to the application, and what its callback throws is lost") {
    std::vector<std::string> lines;
    const auto write = [](void* to, std::int32_t level, const char* name, const char* line) {
        static_cast<std::vector<std::string>*>(to)->push_back(std::to_string(level) + ' ' + name + ": " + line);
        throw 1;
    };
    REQUIRE(pelorus_set_log(PLR_LOG_INFO, write, &lines, nullptr) == PLR_OK);
    {
        Pipeline pipeline = opened();
        CHECK(pipeline.finish().ok());
    }
    REQUIRE(pelorus_set_log(PLR_LOG_INFO, nullptr, nullptr, nullptr) == PLR_OK);
    REQUIRE(lines.size() == 2);
    CHECK_THAT(lines[0], Catch::StartsWith("3 radar (source.external): nothing was pushed"));
    CHECK_THAT(lines[1], Catch::StartsWith("3 tracker (tracker.point_target): no scan came"));
}

TEST_CASE("libpelorus: versions, nodes and ports are told") {
    CHECK(pelorus_api_version() == PELORUS_API_MAJOR * 65536u + PELORUS_API_MINOR);
    CHECK(std::string(pelorus_version()) == PELORUS_VERSION);
    CHECK(pelorus_is_compatible() == 1);
    CHECK(pelorus_serves(PELORUS_API_MAJOR + 1, 0, PLR_MESSAGES) == 0);
    CHECK(pelorus_serves(PELORUS_API_MAJOR, PELORUS_API_MINOR + 1, PLR_MESSAGES) == 0);
    CHECK(pelorus_serves(PELORUS_API_MAJOR, PELORUS_API_MINOR, "pelorus.message/0") == 0);
    CHECK(pelorus_serves(PELORUS_API_MAJOR, PELORUS_API_MINOR, nullptr) == 0);

    const Pipeline pipeline = opened();
    REQUIRE(pipeline.nodes().size() == 2);
    CHECK(std::string(pipeline.nodes()[1].plugin) == "tracker.point_target");
    std::string text;
    for (const pelorus_port_info& port : pipeline.ports())
        text += std::string(port.node) + '.' + port.port + (port.is_output ? " out" : " in") +
                (port.can_push ? " pushed " : " ") + std::to_string(port.stream_count) + '\n';
    CHECK_THAT(text, Contains("radar.scans in pushed 1\n") && Contains("radar.truth in pushed 0\n") &&
                         Contains("radar.scans out 1\n") && Contains("tracker.tracks out "));
}

TEST_CASE("libpelorus: a second thread within a call is refused, not let in") {
    Pipeline pipeline = opened();
    std::vector<plr_status> seen;
    struct Context {
        Pipeline* pipeline;
        std::vector<plr_status>* seen;
    } context{&pipeline, &seen};
    const auto write = [](void* to, std::int32_t, const char*, const char*) {
        const auto& at = *static_cast<Context*>(to);
        std::thread([&] { at.seen->push_back(at.pipeline->advance(0).code()); }).join();
    };
    REQUIRE(pelorus_set_log(PLR_LOG_INFO, write, &context, nullptr) == PLR_OK);
    CHECK(pipeline.finish().ok());  // logs a line for each node
    REQUIRE(pelorus_set_log(PLR_LOG_INFO, nullptr, nullptr, nullptr) == PLR_OK);
    CHECK(seen == std::vector<plr_status>(2, PELORUS_E_BUSY));
}
