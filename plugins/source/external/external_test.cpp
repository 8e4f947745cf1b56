#include "external.hpp"

#include <catch2/catch.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"

namespace {

using namespace pelorus::test;
using source_external::ExternalSource;

std::vector<Instance::Part> one_sensor(Bench& bench) {
    return {{"sensors", "radar", std::make_shared<Instance>(bench, installed("sensor.position")), "{}"}};
}

const plr_external& external_of(const StageUnderTest& stage) {
    const void* found = stage.stage().head.extension(stage.instance().self(), PLR_EXTERNAL);
    REQUIRE(found != nullptr);
    return *static_cast<const plr_external*>(found);
}

}  // namespace

TEST_CASE("source.external has no events of its own and passes on what comes in", "[source.external]") {
    Bench bench;
    StageUnderTest stage(bench, plugin_of<ExternalSource>("source.external"), "{}", one_sensor(bench));
    CHECK(stage.next().what == PLR_NEXT_END);
    pelorus::ScanBuilder scan("radar", "", pelorus::position_space(3));
    const double position[3] = {1, 2, 3};
    scan.add(7, position);
    stage.receive(ExternalSource::scans, scan.message(5), 9);
    REQUIRE(bench.published.size() == 1);
    CHECK(bench.published[0].port == ExternalSource::scans);
    CHECK(bench.published[0].message->time == 5);
    CHECK(bench.published[0].scan().ids[0] == 7);
    pelorus::TruthBuilder truth("", pelorus::position_space(3));
    stage.receive(ExternalSource::truth, truth.message(5), 9);
    CHECK(bench.published.back().port == ExternalSource::truth);
    stage.finish();
    CHECK(bench.log.empty());
}

TEST_CASE("source.external wants and offers the scans of its sensors, and says its policy", "[source.external]") {
    Bench bench;
    StageUnderTest stage(bench, plugin_of<ExternalSource>("source.external"), "{late: keep}", one_sensor(bench),
                         "site");
    for (const std::uint32_t is_output : {0u, 1u}) {
        plr_port_type type{};
        type.struct_size = sizeof type;
        REQUIRE(stage.stage().port_type(stage.instance().self(), is_output, ExternalSource::scans, &type, nullptr) ==
                PLR_OK);
        REQUIRE(type.stream_count == 1);
        CHECK(std::string(type.streams[0].sensor) == "radar");
        CHECK(std::string(type.streams[0].frame) == "site");
        CHECK(type.streams[0].space->size == 3);
    }
    CHECK(external_of(stage).late == PLR_LATE_KEEP);
    CHECK(external_of(StageUnderTest(bench, plugin_of<ExternalSource>("source.external"))).late == PLR_LATE_REFUSE);
}

TEST_CASE("source.external says at the end that nothing was pushed, also after a restart", "[source.external]") {
    Bench bench;
    StageUnderTest idle(bench, plugin_of<ExternalSource>("source.external"));
    idle.finish();
    REQUIRE(bench.log.size() == 1);
    CHECK_THAT(bench.log[0], Catch::Contains("nothing was pushed: this node publishes what an application pushes"));
    StageUnderTest fed(bench, plugin_of<ExternalSource>("source.external"));
    pelorus::TruthBuilder truth("", pelorus::position_space(3));
    fed.receive(ExternalSource::truth, truth.message(5));
    StageUnderTest resumed(bench, plugin_of<ExternalSource>("source.external"));
    resumed.load(fed.save());
    resumed.finish();
    CHECK(bench.log.size() == 1);
}
