// The configs of the examples of the SDK, through the ordinary host: their figures are what theory, or a second filter that shares
// nothing with the plugins, says they must be.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"
#include "example_replay.hpp"

using namespace pelorus::test;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

std::string config_of(const std::string& example) { return PELORUS_SOURCE_DIR "/configs/example_" + example + ".yaml"; }

/// Runs a config and answers its cell of summary.json.
Json run_config(const std::string& config, const std::filesystem::path& out, std::vector<std::string> flags = {}) {
    flags.insert(flags.begin(), {"run", config, "--out", out.string()});
    const Ended ended = pelorus_command(flags);
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
    CHECK_THAT(ended.err, !Contains("warning"));
    return Json::parse(read_file(out / "summary.json"))["cells"][0];
}

double scalar(const Json& cell, const std::string& name) { return cell["scalars"].at(name)["value"].get<double>(); }

std::vector<double> column(const Json& cell, const std::string& table, const std::string& name) {
    const Json& found = cell["tables"].at(table);
    std::vector<double> values;
    for (std::size_t c = 0; c < found["columns"].size(); ++c)
        if (found["columns"][c]["name"] == name)
            for (const Json& row : found["rows"])
                values.push_back(row[c].is_null() ? std::nan("") : row[c].get<double>());
    REQUIRE(!values.empty());
    return values;
}

/// The config with a sink that writes what the tracker saw and what it made of it.
std::string with_files(const TemporaryFolder& folder, const std::string& example, const std::string& tracker) {
    return folder.write("config.yaml", "extend: " + config_of(example) +
                                           "\ngraph:\n  files: {use: sink.csv, with: {uncertainty: covariance}, "
                                           "in: {scans: world.scans, tracks: " +
                                           tracker + ".tracks}}\n");
}

Eigen::MatrixXd matrix2(double a, double b, double c, double d) {
    Eigen::MatrixXd out(2, 2);
    out << a, b, c, d;
    return out;
}

/// A block of two derivatives put on three axes; `size` of the whole.
Eigen::MatrixXd on_axes(const Eigen::MatrixXd& block, const Eigen::Vector3d& scale, Eigen::Index size) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(size, size);
    for (Eigen::Index axis = 0; axis < 3; ++axis)
        for (Eigen::Index r = 0; r < 2; ++r)
            for (Eigen::Index c = 0; c < 2; ++c) out(3 * r + axis, 3 * c + axis) = scale(axis) * block(r, c);
    return out;
}

const std::vector<std::string> six = {"position.x", "position.y", "position.z",
                                      "velocity.x", "velocity.y", "velocity.z"};

/// Variance of the error of a filter on one axis (constant velocity, noise q) that follows an object which really flies straight,
/// after each step of 1 s: the gain is the filter's own, the error knows no process noise. `noise[k]`: variances of the
/// measurements of step k.
std::vector<double> error_variances(double q, const std::vector<std::vector<double>>& noise) {
    const Eigen::MatrixXd f = matrix2(1, 1, 0, 1), noise_of_step = q * matrix2(1.0 / 3, 0.5, 0.5, 1);
    Eigen::MatrixXd believed = matrix2(noise[0][0], 0, 0, 2500), real = believed;
    std::vector<double> variances;
    for (const std::vector<double>& measurements : noise) {
        believed = f * believed * f.transpose() + noise_of_step;
        real = f * real * f.transpose();
        for (const double r : measurements) {
            const Eigen::Vector2d gain = believed.col(0) / (believed(0, 0) + r);
            const Eigen::MatrixXd rest = matrix2(1 - gain(0), 0, -gain(1), 1);
            believed = rest * believed;
            real = rest * real * rest.transpose() + r * gain * gain.transpose();
        }
        variances.push_back(real(0, 0));
    }
    return variances;
}

double root_mean(const std::vector<double>& squares, std::size_t from) {
    double sum = 0;
    for (std::size_t k = from; k < squares.size(); ++k) sum += squares[k];
    return std::sqrt(sum / static_cast<double>(squares.size() - from));
}

}  // namespace

TEST_CASE("example of a coordinated turn: the track is that of a filter with a numerically integrated turn",
          "[release-only]") {
    const TemporaryFolder folder;
    run_config(with_files(folder, "coordinated_turn", "turning"), folder.path() / "out");
    Dynamics turn;
    turn.derivative = [](const Eigen::VectorXd& x) {
        Eigen::VectorXd rate(7);
        rate << x(3), x(4), x(5), -x(6) * x(4), x(6) * x(3), 0, 0;
        return rate;
    };
    turn.noise = [](double dt) {
        Eigen::MatrixXd q = on_axes(integrated_noise(matrix2(0, 1, 0, 0), matrix2(0, 0, 0, 1), dt), {0.2, 0.2, 0.1}, 7);
        q(6, 6) = 1e-4 * dt;
        return q;
    };
    std::vector<std::string> seven = six;
    seven.push_back("turn_rate");
    CHECK(largest_difference(folder.path() / "out", seven, turn, 30) < 1e-4);
}

TEST_CASE("example of a coordinated turn: better than its measurements and than a straight motion, and honest",
          "[release-only]") {
    const TemporaryFolder folder;
    double nees = 0;
    const std::vector<std::string> seeds = {"5", "6", "7", "8"};
    for (const std::string& seed : seeds) {
        const Json cell = run_config(config_of("coordinated_turn"), folder.path() / seed, {"--seed", seed});
        CHECK(scalar(cell, "errors.position_rmse") < 0.6 * 30 * std::sqrt(3.0));
        CHECK(scalar(cell, "errors.position_rmse") < 0.85 * scalar(cell, "straight_errors.position_rmse"));
        CHECK(scalar(cell, "errors.velocity_rmse") < 0.6 * scalar(cell, "straight_errors.velocity_rmse"));
        CHECK(scalar(cell, "errors.track_count") == 1);
        nees += scalar(cell, "errors.nees") / static_cast<double>(seeds.size());
    }
    // 6 where the disturbances are as the model says. Here there are two kinds of flight: without any, and a turn that sets in
    // at once.
    CHECK(nees > 4);
    CHECK(nees < 7);
}

TEST_CASE("example of libc++: the track is that of a filter with a numerically integrated noise", "[release-only]") {
    const TemporaryFolder folder;
    const Json cell = run_config(with_files(folder, "libcxx_motion", "tracker"), folder.path() / "out");
    const Eigen::MatrixXd drift = matrix2(0, 1, 0, -0.01);
    Dynamics fading;
    fading.derivative = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return on_axes(drift, {1, 1, 1}, 6) * x; };
    fading.noise = [&](double dt) { return on_axes(integrated_noise(drift, matrix2(0, 0, 0, 0.4), dt), {1, 1, 1}, 6); };
    CHECK(largest_difference(folder.path() / "out", six, fading, 15) < 1e-4);
    CHECK(scalar(cell, "errors.position_rmse") < 0.6 * 15 * std::sqrt(3.0));
}

TEST_CASE("example of libc++: what it throws comes out as a message, with the place in the config", "[release-only]") {
    const TemporaryFolder folder;
    const std::string config = config_of("libcxx_motion");
    const Ended refused = pelorus_command({"check", config, "--set", "tracker.estimator.motion.rate=0 1/s", "--set",
                                           "tracker.estimator.motion.noise=0 m2/s3"});
    CHECK(refused.exit == 2);
    CHECK_THAT(refused.err,
               Contains("tracker.estimator.motion.noise: ") && Contains("is 0, and so is rate: the velocity could"));
}

TEST_CASE("example of a bearing sensor: the errors along and across the line of sight are as theory says",
          "[release-only]") {
    const std::size_t scans = 500, from = 50;
    std::vector<std::vector<double>> along, across;
    for (std::size_t k = 0; k < scans; ++k) {
        const double cross_range = (30e3 - 20.0 * static_cast<double>(k)) * 0.5e-3;
        along.push_back({100.0 * 100.0});
        across.push_back({100.0 * 100.0, cross_range * cross_range});
    }
    const double expected_along = root_mean(error_variances(0.1, along), from),
                 expected_across = root_mean(error_variances(0.1, across), from);
    const double alone = expected_along;  // what the radar by itself would give across

    const TemporaryFolder folder;
    std::vector<double> x, both;
    for (const std::string seed : {"1", "2", "3", "4", "5", "6", "7", "8"}) {
        const Json cell = run_config(config_of("bearing_sensor"), folder.path() / seed, {"--seed", seed});
        for (const char* axis : {"position.x", "position.y", "position.z"}) {
            const std::vector<double> errors = column(cell, "errors.by_time", axis);
            for (std::size_t k = from; k < errors.size(); ++k)
                (std::string(axis) == "position.x" ? x : both).push_back(errors[k] * errors[k]);
        }
    }
    CAPTURE(expected_along, expected_across);
    // Errors are correlated over about 20 scans along, 8 across: so many independent ones are left that 3 deviations are this much.
    CHECK(root_mean(x, 0) == Approx(expected_along).epsilon(0.2));
    CHECK(root_mean(both, 0) == Approx(expected_across).epsilon(0.1));
    CHECK(expected_across < 0.25 * alone);
}

TEST_CASE("example of a zone alarm: entry and exit when geometry says, and none along the edge", "[release-only]") {
    const TemporaryFolder folder;
    // 100 m/s from x = -10 km: 100 m inside the edge at -2 km after 81 s, 100 m outside that at 2 km after 121 s.
    for (const std::string seed : {"3", "4", "5"}) {
        const Json cell = run_config(config_of("zone_alarm"), folder.path() / seed, {"--seed", seed});
        CHECK(scalar(cell, "alarm.entries") == 1);
        CHECK(scalar(cell, "alarm.exits") == 1);
        CHECK(scalar(cell, "alarm.lost") == 0);
        CHECK(std::fabs(scalar(cell, "alarm.first_entry") - 81) <= 1);
        CHECK(std::fabs(scalar(cell, "alarm.inside_time") - 40) <= 2);
        const Json& rows = cell["tables"]["alarm.incidents"]["rows"];
        REQUIRE(rows.size() == 2);
        CHECK(rows[0][3] == "entered");
        CHECK(rows[1][3] == "left");
        CHECK(std::fabs(rows[1][4].get<double>() - 2100) < 110);
    }
    const Json nervous = run_config(config_of("zone_alarm"), folder.path() / "nervous", {"--set", "alarm.margin=0m"});
    CHECK(scalar(nervous, "alarm.entries") > 3);
}

TEST_CASE("example of a zone alarm: a track that ends inside is lost, one that is inside at the end counts so far",
          "[release-only]") {
    const TemporaryFolder folder;
    const Json lost =
        run_config(config_of("zone_alarm"), folder.path() / "lost", {"--set", "world.targets.crossing.death=100s"});
    CHECK(scalar(lost, "alarm.entries") == 1);
    CHECK(scalar(lost, "alarm.exits") == 0);
    CHECK(scalar(lost, "alarm.lost") == 1);
    CHECK(std::fabs(scalar(lost, "alarm.inside_time") - 19) <= 7);  // it is missed five times before it ends
    const Json early = run_config(config_of("zone_alarm"), folder.path() / "early", {"--set", "world.scans=101"});
    CHECK(scalar(early, "alarm.exits") == 0);
    CHECK(std::fabs(scalar(early, "alarm.inside_time") - 19) <= 1);
}

TEST_CASE("example of a zone alarm: a run that goes on from a snapshot tells the same", "[release-only]") {
    const TemporaryFolder folder;
    const std::string config = config_of("zone_alarm");
    run_config(config, folder.path() / "whole");
    for (const std::string time : {"60 s", "100 s", "150 s"}) {  // before, while and after the aircraft is inside
        const Ended half =
            pelorus_command({"run", config, "--out", folder / "half", "--snapshot-at", time, "--stop-at-snapshot"});
        REQUIRE(half.exit == 0);
        const Ended resumed = pelorus_command({"run", config, "--out", folder / "rest", "--resume", folder / "half"});
        REQUIRE(resumed.exit == 0);
        CHECK(folder.read("rest/summary.json") == folder.read("whole/summary.json"));
        std::filesystem::remove_all(folder.path() / "half");
        std::filesystem::remove_all(folder.path() / "rest");
    }
}

TEST_CASE("example of a zone alarm: a zone that is none is refused", "[release-only]") {
    const auto refused = [](const std::string& zone, const std::string& text) {
        const Ended ended = pelorus_command({"check", config_of("zone_alarm"), "--set", "alarm.zone=" + zone});
        CAPTURE(zone, ended.err);
        CHECK(ended.exit == 2);
        CHECK_THAT(ended.err, Contains("alarm.zone") && Contains(text));
    };
    refused("[[0 m, 0 m], [1 m, 0 m]]", "at least 3");
    refused("[[0 m, 0 m], [0 m, 0 m], [1 m, 0 m]]", "corner 1 and the one after it coincide");
    refused("[[0 m, 0 m], [1 m, 1 m], [2 m, 2 m]]", "enclose no area");
    refused("[[0 m, 0 m, 0 m], [1 m, 0 m, 0 m], [1 m, 1 m, 0 m]]", "column");
}

TEST_CASE("example of a partitioner in C: the clouds that it splits are two, one where they cross, and two",
          "[release-only]") {
    const TemporaryFolder folder;
    const Json cell = run_config(config_of("distance_partitioner"), folder / "out");
    CHECK(scalar(cell, "groups.count_at_50") == 2);
    CHECK(scalar(cell, "groups.count_at_90") == 1);
    CHECK(scalar(cell, "groups.count_at_150") == 2);
}
