#include <catch2/catch.hpp>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "calibration_rig.hpp"

using namespace calibration;

namespace {

const char* const all = "attitude_sd: 2 mrad, position_sd: 3 m, range_sd: 5 m, clock_sd: 50 ms, maximum_speed: 60 m/s";

std::string with(const std::string& text) { return "{" + text + "}"; }

std::map<std::string, double> scalars_of(const Rig& rig) {
    std::map<std::string, double> scalars;
    for (const auto& published : rig.bench.published)
        if (published.message->kind == PLR_MESSAGE_TABLE)
            for (std::uint32_t i = 0; i < published.table().scalar_count; ++i)
                scalars[published.table().scalars[i].name] = published.table().scalars[i].value;
    return scalars;
}

}  // namespace

TEST_CASE("calibration: each bias is found within what is not known of it", "[registration]") {
    World world = precise();
    world.biases << 1e-3, -1.5e-3, 0.8e-3, 2, -1.5, 1, -4, 0.03;
    Rig rig(world, with(std::string(all) + ", presence: 1"));
    rig.run(0, 300);
    const BiasMatrix p = rig.biases().covariance();
    for (int bias = 0; bias < bias_count; ++bias) {
        INFO(bias_names[static_cast<std::size_t>(bias)].name);
        const double sd = std::sqrt(p(bias, bias));
        CHECK(std::abs(rig.biases().mean()(bias) - world.biases(bias)) < 3.5 * sd);
        CHECK(rig.biases().ratio(bias) < 0.3);
    }
    CHECK(std::abs(rig.biases().mean()(yaw) - 0.8e-3) < 1e-4);
    CHECK(std::abs(rig.biases().mean()(clock_offset) - 0.03) < 3e-3);
}

TEST_CASE("calibration: the filter's deviations are the errors' (NEES)", "[registration]") {
    // Over 60 runs, biases drawn from the priors: the mean of a chi-squared of 8 degrees of freedom, with 99.9 % bounds.
    double sum = 0;
    const int runs = 60;
    for (int run = 0; run < runs; ++run) {
        std::mt19937_64 random(1000u + static_cast<unsigned>(run));
        std::normal_distribution<double> normal;
        World world = precise();
        world.seed = static_cast<unsigned>(run) + 1;
        const double sd[] = {2e-3, 2e-3, 2e-3, 3, 3, 3, 5, 0.05};
        for (int bias = 0; bias < bias_count; ++bias) world.biases(bias) = sd[bias] * normal(random);
        Rig rig(world, with(std::string(all) + ", presence: 1"));
        rig.run(0, 60);
        const BiasVector e = rig.biases().mean() - world.biases;
        sum += e.dot(Eigen::LLT<BiasMatrix>(rig.biases().covariance()).solve(e));
    }
    const double deviation = std::sqrt(2.0 * bias_count / runs);
    INFO("mean NEES " << sum / runs);
    CHECK(sum / runs > bias_count - 3.3 * deviation);
    CHECK(sum / runs < bias_count + 3.3 * deviation);
}

TEST_CASE("calibration: it says since when a bias is observable", "[registration]") {
    // 1 mrad against 3 mrad: the deviation is half the prior one once 1 + n / 9 = 4, at the 27th fix; as the sensor is
    // tilted by 2 deg against the radar, which adds some of its zenith error, a little later.
    Rig rig(World{}, "{attitude_sd: [0 rad, 0 rad, 1 mrad]}");
    rig.run(0, 100);
    rig.stage->finish(100 * second);
    const auto scalars = scalars_of(rig);
    CHECK(scalars.at("yaw_observable") == 1);
    CHECK(scalars.at("yaw_observable_since") == Approx(56).margin(4));
    CHECK(scalars.at("yaw_deviation") > 0);
}

TEST_CASE("calibration: a yaw seen by a radar of 3 mrad is known as well as the mean of its angles", "[registration]") {
    const bool is_passive = GENERATE(false, true);
    World world = wrong(yaw, 1e-3);
    world.is_passive = is_passive;
    Rig rig(world, "{attitude_sd: [0 rad, 0 rad, 1 mrad], presence: 1}");
    rig.run(0, 400);  // 199 pairs: the last fix waits for frames after it
    CHECK(rig.biases().ratio(yaw) == Approx(1 / std::sqrt(1 + 199 / 9.0)).epsilon(0.02));
    CHECK(std::abs(rig.biases().mean()(yaw) - 1e-3) < 3 * 3e-3 / std::sqrt(199));
}

TEST_CASE("calibration: where nothing is wrong nothing is corrected, where something is it is found",
          "[registration]") {
    double right = 0, found = 0, filter = 0;
    const int runs = 20;
    for (int run = 0; run < runs; ++run) {
        World world;
        world.seed = static_cast<unsigned>(run) + 1;
        Rig clean(world, "{attitude_sd: 1 mrad}");
        clean.run(0, 300);
        right += clean.biases().estimate().value.squaredNorm();
        filter += clean.biases().mean().squaredNorm();
        world.biases(yaw) = 1e-3;
        Rig turned(world, "{attitude_sd: 1 mrad}");
        turned.run(0, 300);
        found += std::abs(turned.biases().estimate().value(yaw) - 1e-3);
    }
    INFO("deviation of the estimate " << std::sqrt(right / runs) << ", of the filter " << std::sqrt(filter / runs)
                                      << ", mean error with a yaw " << found / runs);
    CHECK(right < 0.5 * filter);
    CHECK(found / runs < 0.4e-3);
}

TEST_CASE("calibration: a turn about the line of sight is told as not observable", "[registration]") {
    // A target that stays in one direction tells nothing of a turn about it.
    World world;
    world.targets = {
        [](double t) { return Eigen::Vector3d(Eigen::Vector3d(10, 5, 3) + (1000 + t) * Eigen::Vector3d::Ones()); }};
    Rig rig(world, "{attitude_sd: 1 mrad}");
    rig.run(0, 600);
    const Direction least = rig.biases().directions().front();
    CHECK(least.ratio > 0.98);
    // Told about the sensor's own axes: the direction in which it sees the target.
    const Eigen::Vector3d z = rig.seen_by_eo(world.targets[0](0), BiasVector::Zero());
    const Eigen::Vector3d sight(std::sin(z(2)) * std::cos(z(1)), std::sin(z(2)) * std::sin(z(1)), std::cos(z(2)));
    CHECK((least.share.segment<3>(roll) - sight).norm() < 0.01);
    rig.stage->finish(600 * second);
    const auto scalars = scalars_of(rig);
    CHECK(scalars.at("yaw_observable") == 0);
    CHECK(std::isnan(scalars.at("yaw_observable_since")));
    CHECK(scalars.count("offset_x") == 0);
}

TEST_CASE("calibration: corrected measurements are those of a sensor without biases", "[registration]") {
    World world = precise();
    world.biases << 1e-3, -1.5e-3, 0.8e-3, 2, -1.5, 1, -4, 0.03;
    world.is_passive = GENERATE(false, true);
    if (world.is_passive) world.biases(range_bias) = 0;
    const std::string priors =
        world.is_passive ? "attitude_sd: 2 mrad, position_sd: 3 m, clock_sd: 50 ms, maximum_speed: 60 m/s" : all;
    Rig rig(world, with(priors + ", presence: 1"));
    rig.run(0, 300);
    rig.bench.published.clear();
    rig.world.eo_sd.setConstant(1e-12);
    rig.radar(302);
    rig.bench.published.clear();
    const double t = 302.01;
    rig.eo(t);
    REQUIRE(rig.bench.published.front().port == CalibrationStage::scans_out);
    const plr_scan& scan = rig.bench.published.front().scan();
    // Judged by the direction and range that it would have without errors; its stamp, too, is that of the true time.
    CHECK(std::abs(static_cast<double>(rig.bench.published.front().message->time) * 1e-9 - t) < 3e-3);
    for (std::int64_t i = 0; i < 2; ++i) {
        const Eigen::Vector3d right = rig.seen_by_eo(world.targets[static_cast<std::size_t>(i)](t), BiasVector::Zero());
        const Eigen::VectorXd z = pelorus::item(scan.measurements, i);
        if (!world.is_passive) CHECK(std::abs(z(0) - right(0)) < 0.5);
        for (int c = 0; c < 2; ++c) CHECK(std::abs(z(c + (world.is_passive ? 0 : 1)) - right(c + 1)) < 1.5e-4);
    }
}

TEST_CASE("calibration: the values make a model of the sensor see what it sees", "[registration]") {
    World world = wrong(yaw, 5e-3);
    world.radar_sd = {0.1, 1e-5, 1e-5};
    world.biases(range_bias) = 7;
    Rig rig(world, "{attitude_sd: 10 mrad, range_sd: 10 m, presence: 1}");
    rig.run(0, 200);
    std::map<std::string, Eigen::VectorXd> values;
    std::map<std::string, std::string> units;
    for (const auto& published : rig.bench.published)
        if (published.port == CalibrationStage::values_out)
            for (std::uint32_t i = 0; i < published.message->body.values->count; ++i) {
                const plr_quantity& quantity = published.message->body.values->quantities[i];
                values[quantity.name] = pelorus::item(quantity.numbers, 0);
                units[quantity.name] = quantity.unit;
            }
    REQUIRE(values.size() == 2);
    CHECK(units.at("eo.bias") == "m, rad, rad");
    CHECK(values.at("eo.bias")(0) == Approx(7).margin(0.5));
    CHECK(values.at("eo.attitude_error")(2) == Approx(5e-3).margin(2e-5));
}

TEST_CASE("calibration: what is not of its sensors passes, what is right passes unchanged", "[registration]") {
    Rig rig(World{}, "{}");
    const double z[] = {1, 2, 3};
    pelorus::ScanBuilder other("lidar", "elsewhere", pelorus::position_space(3));
    other.add(7, z);
    rig.receive(other, 1);
    REQUIRE(rig.bench.published.size() == 1);
    CHECK(std::string(rig.bench.published[0].scan().sensor) == "lidar");
    rig.radar(2);
    pelorus::ScanBuilder sent = rig.eo_scan(2);
    rig.receive(sent, 2);
    const plr_scan& passed = rig.bench.published.back().scan();
    CHECK(pelorus::item(passed.measurements, 0) == pelorus::item(sent.message(0).body.scan->measurements, 0));
    rig.stage->finish(3 * second);
    CHECK(rig.bench.published.size() == 3);  // no values, no table: nothing is estimated
}

TEST_CASE("calibration: a Schmidt filter moves nothing and adds what may be", "[registration]") {
    World world;
    Rig rig(world, "{mode: schmidt, attitude_sd: [0 rad, 0 rad, 1 mrad], presence: 1}");
    rig.radar(2);
    pelorus::ScanBuilder sent = rig.eo_scan(2);
    rig.receive(sent, 2);
    const plr_scan& scan = rig.bench.published.back().scan();
    CHECK(pelorus::item(scan.measurements, 0) == pelorus::item(sent.message(0).body.scan->measurements, 0));
    const Eigen::MatrixXd noise = pelorus::item(scan.covariances, 0);
    // A turn about its own z shows in the azimuth by as much.
    CHECK(std::sqrt(noise(1, 1)) == Approx(1e-3).epsilon(1e-3));
    CHECK(noise(0, 0) == Approx(25));
    rig.run(2, 400);
    for (auto published = rig.bench.published.rbegin(); published != rig.bench.published.rend(); ++published)
        if (published->message->kind == PLR_MESSAGE_SCAN && std::string(published->scan().sensor) == "eo") {
            CHECK(std::sqrt(pelorus::item(published->scan().covariances, 0)(1, 1)) < 0.6e-3);
            break;
        }
}

TEST_CASE("calibration: two targets near each other teach nothing wrong", "[registration]") {
    // 10 m apart at 1 km is 10 mrad, where a radar of 3 mrad cannot tell them: such fixes are left out.
    World world = wrong(yaw, 1e-3);
    const Path one = circle();
    world.targets = {one, [one](double t) { return Eigen::Vector3d(one(t) + Eigen::Vector3d(0, 0, 10)); },
                     circle(-0.01, 3000, 1000)};
    Rig rig(world, "{attitude_sd: [0 rad, 0 rad, 1 mrad], presence: 1}");
    rig.run(0, 300);
    CHECK(rig.bench.counters["fixes_without_partner"] > 150);
    CHECK(rig.bench.counters["pairs"] > 140);
    CHECK(std::abs(rig.biases().mean()(yaw) - 1e-3) < 4 * 3e-3 / std::sqrt(150));
}

TEST_CASE("calibration: late, repeated and missing frames cost only themselves", "[registration]") {
    const World world = wrong(yaw, 1e-3);
    const char* const yaw_alone = "{attitude_sd: [0 rad, 0 rad, 1 mrad], presence: 1}";
    Rig tidy(world, yaw_alone), untidy(world, yaw_alone);
    tidy.run(0, 100);
    std::vector<std::pair<double, pelorus::ScanBuilder>> late;
    for (int i = 1; i <= 2000; ++i) {
        const double t = i * 0.05;
        if (i % 40 == 0) untidy.radar(t);
        pelorus::ScanBuilder scan = untidy.eo_scan(t);
        if (i % 3 == 1) {  // comes 0.4 s late, and twice
            late.emplace_back(t, std::move(scan));
        } else {
            untidy.receive(scan, t);
        }
        while (!late.empty() && (late.front().first < t - 0.4)) {
            untidy.receive(late.front().second, late.front().first);
            untidy.receive(late.front().second, late.front().first);
            late.erase(late.begin());
        }
    }
    CHECK(untidy.bench.counters["pairs"] == tidy.bench.counters["pairs"]);
    CHECK(untidy.biases().mean()(yaw) == Approx(tidy.biases().mean()(yaw)).margin(2e-5));
    CHECK(untidy.biases().ratio(yaw) == Approx(tidy.biases().ratio(yaw)).epsilon(1e-3));

    // No frames for a minute: fixes wait no longer than they may, and learning goes on afterwards.
    for (double t = 102; t <= 160; t += 2) tidy.radar(t);
    const auto pairs = tidy.bench.counters["pairs"];
    tidy.run(160, 180);
    CHECK(tidy.bench.counters["pairs"] == pairs + 9);
}

TEST_CASE("calibration: a saved one goes on bit for bit", "[registration]") {
    const World world = wrong(yaw, 1e-3);
    Rig whole(world, with(all)), first(world, with(all)), rest(world, with(all));
    whole.run(0, 41.3);
    first.run(0, 41.3);
    rest.stage->load(first.stage->save());
    whole.bench.published.clear();
    first.bench.published.clear();
    // The random numbers of `first` go on, so its scans are shown to the third one.
    for (int i = 827; i <= 1200; ++i) {
        const double t = i * 0.05;
        if (i % 40 == 0) {
            const auto scan = first.radar_scan(t);
            first.receive(scan, t);
            rest.receive(scan, t);
        }
        const auto scan = first.eo_scan(t);
        first.receive(scan, t);
        rest.receive(scan, t);
    }
    CHECK(first.stage->save() == rest.stage->save());
    CHECK(first.bench.published.size() == rest.bench.published.size());
    CHECK(first.biases().estimate().value == rest.biases().estimate().value);
    Rig other(world, "{attitude_sd: 1 mrad}");
    CHECK_THROWS_WITH(other.stage->load(first.stage->save()), "the saved biases are of other parameters");
}

TEST_CASE("calibration: what cannot be is refused in one line", "[registration]") {
    World passive;
    passive.is_passive = true;
    CHECK_THROWS_WITH(Rig(passive, "{range_sd: 1 m}"),
                      "range_sd: is for a sensor of ranges; eo measures azimuth [rad], zenith [rad]");
    CHECK_THROWS_WITH(Rig(World{}, "{sensor: radar, reference: radar}"),
                      "sensor: is radar, which is the reference already");
    CHECK_THROWS_WITH(Rig(World{}, "{sensor: sonar}"), "sensor: is sonar, the slot `sensors` has radar, eo");
    CHECK_THROWS_WITH(Rig(passive, "{sensor: radar}"),
                      "sensors: the reference eo tells no position by a single measurement");
}

TEST_CASE("calibration: how a sensor stands is found by asking its model", "[registration]") {
    using namespace pelorus::test;
    const std::string in_space = "position: [1000 m, -200 m, 30 m], attitude: [0.1 rad, -0.2 rad, 2.5 rad], angle: ";
    const auto [id, with, dimension] = GENERATE_COPY(
        table<std::string, std::string, int>({{"sensor.spherical", in_space + "zenith", 3},
                                              {"sensor.spherical", in_space + "elevation", 3},
                                              {"sensor.bearings", in_space + "zenith", 3},
                                              {"sensor.bearings", in_space + "elevation", 3},
                                              {"sensor.polar", "position: [1000 m, -200 m], yaw: 2.5 rad", 2}}));
    INFO(id << " " << with);
    Bench bench;
    const plr_plugin& plugin = installed(id);
    const Instance instance(bench, plugin, "{" + with + "}");
    plr_part part{};
    part.struct_size = sizeof part;
    part.slot = part.name = part.address = "eo";
    part.table_id = PLR_SENSOR;
    part.description = plugin.description;
    part.instance.self = instance.self();
    part.instance.table = reinterpret_cast<const plr_table_head*>(&instance.table<plr_sensor>());
    const SensorModel sensor(pelorus::SensorPart(part), "sensors");
    plr_config config{};
    config.struct_size = sizeof config;
    config.host = bench.host();
    pelorus::Caller caller;
    caller.setup(pelorus::Setup(config), static_cast<std::size_t>(sensor.scratch_bytes()) + 4096);

    const Pose pose = sensor.pose(caller, Eigen::Vector3d(-300, 900, dimension == 2 ? 0 : 400));
    BiasVector angles = BiasVector::Zero();
    angles.segment<3>(roll) = dimension == 2 ? Eigen::Vector3d(0, 0, 2.5) : Eigen::Vector3d(0.1, -0.2, 2.5);
    CHECK((pose.position - Eigen::Vector3d(1000, -200, dimension == 2 ? 0 : 30)).norm() < 1e-8);
    CHECK((pose.rotation - misalignment(angles)).norm() < 1e-10);
    CHECK(sensor.measures_range() == (id != "sensor.bearings"));
}

TEST_CASE("calibration: a slow sensor is calibrated against a fast one, each of its frames once", "[registration]") {
    World world = wrong(yaw, 2e-3);
    world.eo_sd = {5, 3e-3, 3e-3};
    world.radar_sd = {1, 1e-4, 1e-4};
    Rig rig(world, "{attitude_sd: [0 rad, 0 rad, 1 mrad], window: 7 s, presence: 1}");
    for (int i = 1; i <= 6000; ++i) {
        const double t = i * 0.05;
        rig.radar(t);
        if (i % 40 == 0) rig.eo(t);
    }
    // 150 frames of 3 mrad. A parabola through three or four of them is worse than their mean, so less than all is learnt.
    const double all_of_them = 3e-3 / std::sqrt(150 + 9);
    const double deviation = rig.biases().ratio(yaw) * 1e-3;
    CHECK(deviation > all_of_them);
    CHECK(deviation < 2 * all_of_them);
    CHECK(std::abs(rig.biases().mean()(yaw) - 2e-3) < 4 * deviation);
}
