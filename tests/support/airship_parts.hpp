// The airship's tracker, made of the real plugins: for tests of single stages.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pelorus/messages.hpp>

#include "../fixtures/stage_bench.hpp"
#include "plugin_instance.hpp"

namespace test_support {

using pelorus::test::Bench;
using BenchInstance = pelorus::test::Instance;
using pelorus::test::StageUnderTest;
using Part = BenchInstance::Part;

constexpr std::int64_t second = 1'000'000'000;

inline std::shared_ptr<const BenchInstance> part(Bench& bench, const std::string& kind, const std::string& name,
                                                 const std::string& with = "{}", std::vector<Part> parts = {}) {
    return std::make_shared<const BenchInstance>(bench, plugin(kind, name), with, std::move(parts));
}

inline const char* const airship_motion =
    "{form: truncated, maneuver_rate: 0.1 1/s, acceleration: 0.1 m/s2, prior_acceleration: 0.5 m/s2}";

/// Whether parameters of extent.random_matrix name an update that has the kinematics, too.
inline bool is_joint(const std::string& extent) {
    for (const char* update : {"koch", "lan_li", "variational"})
        if (extent.find(update) != std::string::npos) return true;
    return false;
}

/// What stands in the slots of tracker.extended_target: a Kalman filter beside the extent, or, with a joint update, nothing.
inline std::vector<Part> airship_tracker_parts(Bench& bench, const std::string& extent,
                                               const std::string& sensor = "position",
                                               const std::string& sensor_with = "{noise: 1 m}") {
    const auto radar = part(bench, "sensor", sensor, sensor_with);
    const auto motion = part(bench, "motion", "singer", airship_motion);
    std::vector<Part> inner{{"motion", "", motion}, {"sensors", "radar", radar}};
    if (is_joint(extent)) return {{"extent", "", part(bench, "extent", "random_matrix", extent, inner)}};
    return {{"estimator", "", part(bench, "estimator", "kalman", "{}", inner)},
            {"extent", "", part(bench, "extent", "random_matrix", extent)}};
}

/// A scan of sensor `radar`: points as columns, each with covariance `noise` (or none).
inline pelorus::ScanBuilder radar_scan(const Eigen::MatrixXd& points, const Eigen::MatrixXd& noise,
                                       std::uint64_t first_id = 1) {
    pelorus::ScanBuilder scan("radar", "", pelorus::position_space(static_cast<int>(points.rows())));
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
        const Eigen::VectorXd point = points.col(k);
        scan.add(first_id + static_cast<std::uint64_t>(k), point.data(), noise.size() == 0 ? nullptr : noise.data());
    }
    return scan;
}

}  // namespace test_support
