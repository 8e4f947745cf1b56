// `pelorus schema`: what it says of configs is what the command itself says of them.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <sstream>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

const char* const good = R"(
pelorus: 1
title: 7
x-free: [1, {a: b}]
run: {seed: 18446744073709551615}
frames:
  site: {origin: [43.1 deg, 5.9 deg, 12 m]}
  mast: {parent: site, translation: [0, 0, 20 m], attitude: 0}
graph:
  world:
    use: source.simulation
    with: {scans: 60, period: 2 s}
    parts:
      targets:
        aircraft:
          use: trajectory.legs
          with: {start: [-5 km, 2 km, 1 km], speed: 120 m/s, legs: [{duration: 40 s}, {duration: 3e1, turn_rate: 3 deg/s}]}
      sensors:
        radar: {use: sensor.position, with: {noise: 20 m, detection_probability: 95 %}}
  tracker:
    use: tracker.point_target
    in: {scans: [world.scans]}
    with: {maximum_speed: 300 m/s, publish: all}
    parts:
      estimator:
        use: estimator.kalman
        parts:
          motion: {use: motion.constant_velocity, with: {noise: 20 m2/s3}}
          sensors: {radar: {like: world.sensors.radar, with: {noise: 30 m}}}
  errors:
    use: analyzer.tracking_error
    in: {tracks: tracker.tracks, truth: previous(world.truth)}
    frame: site
campaign:
  runs: 3
  sweep: {world.sensors.radar.noise: [1 m, 2 m], both: {a.b: [1, 2], c.d: [3, 4]}}
  variants: {plain: {}, other: {tracker.publish: updated}}
)";

class Schema {
public:
    Schema() {
        const Ended ended = pelorus_command({"schema", "--out", file_.string()});
        REQUIRE(ended.exit == 0);
        REQUIRE(ended.out.empty());
    }

    Ended validate(const std::vector<std::string>& configs) const { return validate_configs(file_, configs); }
    Ended validate_text(const std::string& text) const { return validate({write("config.yaml", text)}); }
    std::string write(const std::string& name, const std::string& text) const { return folder_.write(name, text); }

private:
    TemporaryFolder folder_;
    fs::path file_ = folder_.path() / "schema.json";
};

std::string replaced(const std::string& part, const std::string& by) {
    std::string text = good;
    const std::size_t at = text.find(part);
    REQUIRE(at != std::string::npos);
    return text.replace(at, part.size(), by);
}

std::string lines_that_begin_with(const std::string& beginning, const std::string& text) {
    std::istringstream lines(text);
    std::string found;
    for (std::string line; std::getline(lines, line);)
        if (line.rfind(beginning, 0) == 0) found += line + "\n";
    return found;
}

}  // namespace

// Those of the examples need their plugins, which builds with sanitizers do not have.
TEST_CASE("schema: every config that is shipped is valid", "[release-only]") {
    const Schema schema;
    std::vector<std::string> configs;
    for (const auto& entry : fs::recursive_directory_iterator(PELORUS_SOURCE_DIR "/configs"))
        if (entry.path().extension() == ".yaml" && entry.path().stem().extension() != ".expected")
            configs.push_back(entry.path().string());
    REQUIRE(configs.size() >= 3);
    const Ended ended = schema.validate(configs);
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 0);
}

TEST_CASE("schema: all that a config may hold is valid") {
    const Ended ended = Schema().validate_text(good);
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 0);
}

TEST_CASE("schema: a file that extends another may leave out and take away") {
    const Ended ended = Schema().validate_text(R"(
extend: base.yaml
title: ~
frames: ~
graph:
  world: {parts: {sensors: {radar: {with: {noise: 80 m, period: ~}}, lidar: ~}}}
  tracker:
    with: {publish: ~}
    parts: {estimator: {parts: {motion: {use: motion.singer, with: {noise: ~}}}}}
  errors: ~
)");
    CAPTURE(ended.out, ended.err);
    CHECK(ended.exit == 0);
}

TEST_CASE("schema: what is wrong is refused, at its place", "[release-only]") {
    struct Wrong {
        std::string part, by, place, text;
    };
    const std::vector<Wrong> all{
        {"pelorus: 1", "pelorus: 2", "pelorus", "1 was expected"},
        {"pelorus: 1", "", "", "'pelorus' is a required property"},
        {"title: 7", "titel: 7", "", "'titel' does not match"},
        {"seed: 18446744073709551615", "seed: -1", "run.seed", "less than the minimum"},
        {"translation: [0, 0, 20 m]", "translation: [0, 0]", "frames.mast.translation", "too short"},
        {"[43.1 deg, 5.9 deg, 12 m]", "[1, 2, 3], parent: mast", "frames.site", "False schema does not allow 'mast'"},
        {"use: source.simulation", "use: source.simulaton", "graph.world.use", "is not one of"},
        {"use: source.simulation", "use: motion.singer", "graph.world.use", "is not one of"},
        {"    use: source.simulation\n", "", "graph.world", "'use' is a required property"},
        {"with: {scans: 60", "wiht: {scans: 60", "graph.world", "'wiht' was unexpected"},
        {"period: 2 s", "peroid: 2 s", "graph.world.with", "'peroid' was unexpected"},
        {"scans: 60", "scans: sixty", "graph.world.with.scans", "not of type 'integer'"},
        {"scans: 60", "scans: 0", "graph.world.with.scans", "less than the minimum"},
        {"period: 2 s", "period: [2 s]", "graph.world.with.period", "is not of type"},
        {"period: 2 s", "period: soon", "graph.world.with.period", "does not match"},
        {"targets:", "tragets:", "graph.world.parts", "'tragets' was unexpected"},
        {"targets:", "targets: {}\n      more:", "graph.world.parts", "'more' was unexpected"},
        {"use: trajectory.legs", "use: sensor.position", "graph.world.parts.targets.aircraft.use", "is not one of"},
        {"turn_rate: 3 deg/s", "turnrate: 3 deg/s", "with.legs.1", "'turnrate' was unexpected"},
        {"noise: 20 m,", "noise: -20,", "graph.world.parts.sensors.radar.with.noise", "less than or equal"},
        {"detection_probability: 95 %", "detection_probability: 1.5", "with.detection_probability", "maximum of 1"},
        {"radar: {use:", "like: {use:", "graph.world.parts.sensors.like", "is not of type 'string'"},
        {"scans: [world.scans]", "scans: worldscans", "graph.tracker.in.scans", "does not match"},
        {"scans: [world.scans]", "scan: world.scans", "graph.tracker.in", "'scans' is a required property"},
        {"{maximum_speed: 300 m/s, publish: all}", "{}", "graph.tracker.with",
         "'maximum_speed' is a required property"},
        {"publish: all", "publish: al", "graph.tracker.with.publish", "is not one of ['updated', 'all']"},
        {"publish: all", "publish: ~", "graph.tracker.with.publish", "is not one of"},
        {"motion: {use: motion.constant_velocity", "motion: {use: sensor.position",
         "graph.tracker.parts.estimator.parts.motion.use", "is not one of"},
        {"like: world.sensors.radar", "like: world.sensors.radar, use: sensor.position", "sensors.radar",
         "False schema does not allow 'sensor.position'"},
        {"runs: 3", "runs: 0", "campaign.runs", "less than the minimum"},
        {"[1 m, 2 m]", "1 m", "campaign.sweep.world.sensors.radar.noise", "is not of type"},
    };
    // All at once: the validator takes a second to read the schema.
    const Schema schema;
    std::vector<std::string> files;
    for (const Wrong& wrong : all)
        files.push_back(schema.write(std::to_string(files.size()) + ".yaml", replaced(wrong.part, wrong.by)));
    const Ended ended = schema.validate(files);
    CHECK(ended.exit == 1);
    for (std::size_t k = 0; k < all.size(); ++k) {
        const std::string told = lines_that_begin_with(files[k] + ": ", ended.out);
        CAPTURE(all[k].by, told, ended.err);
        CHECK_THAT(told, Contains(all[k].place + ": ") && Contains(all[k].text));
    }
}

TEST_CASE("schema: carries the plugins' own words, defaults and choices") {
    const auto schema = nlohmann::json::parse(pelorus_command({"schema"}).out);
    const auto& singer = schema["definitions"]["parameters:motion.singer"]["properties"];
    CHECK_THAT(singer["maneuver_rate"]["description"].get<std::string>(),
               Contains("reciprocal of the manoeuvres' time constant") && Contains("double [1/s]"));
    CHECK(singer["maneuver_rate"]["default"] == "0.1 1/s");
    CHECK(singer["maneuver_rate"]["exclusiveMinimum"] == 0);
    CHECK(singer["form"]["enum"] == nlohmann::json({"exact", "truncated"}));
    CHECK_THAT(singer["form"]["enumDescriptions"][0].get<std::string>(), Contains("sampled"));
    CHECK(singer["dimension"]["default"] == 3);
}

TEST_CASE("schema: the one that is built for editors is that of the shipped plugins") {
    CHECK(read_file(PELORUS_BUILD_DIR "/share/pelorus/config.schema.json") == shipped_command({"schema"}).out);
}
