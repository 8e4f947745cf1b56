/// The tracker with everything in its slots, and a target to track: for its tests.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <Eigen/Core>
#include <pelorus/innovations.hpp>
#include <pelorus/sensor.hpp>

#include "../../../tests/support/airship_parts.hpp"

namespace extended_target {

struct Entry {
    std::uint64_t id;
    std::int64_t time;
    std::int32_t status, misses;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance, extent;
    std::vector<std::uint64_t> measurements;
};

/// A tracker with everything in its slots, and a target that flies past.
struct Tracking {
    test_support::Bench bench;
    test_support::StageUnderTest tracker;

    explicit Tracking(const std::string& extent = "{}", const std::string& with = "{}",
                      const std::string& sensor = "position", const std::string& sensor_with = "{noise: 1 m}")
        : tracker(bench, test_support::plugin("tracker", "extended_target"), with,
                  test_support::airship_tracker_parts(bench, extent, sensor, sensor_with)) {}

    void scan(int k, int points = 8) { scan_at(k, target_points(k, points)); }
    void scan_at(int k, const Eigen::MatrixXd& points, const Eigen::MatrixXd& noise = Eigen::MatrixXd::Identity(3, 3)) {
        auto message = test_support::radar_scan(points, noise, static_cast<std::uint64_t>(100 * k + 1));
        tracker.receive(0, message.message(k * test_support::second));
    }
    void empty(int k) { scan_at(k, Eigen::MatrixXd(3, 0)); }

    static Eigen::MatrixXd target_points(int k, int points) {
        Eigen::MatrixXd unit(3, points);
        pelorus::host::random_service().normal({{77, static_cast<std::uint64_t>(k)}}, 0, unit.size(), unit.data());
        return (Eigen::Vector3d(12, 5, 5).asDiagonal() * unit).colwise() + centre(k);
    }
    static Eigen::Vector3d centre(int k) { return {20.0 * k, 100, 300 - 2.0 * k}; }

    std::vector<Entry> told() const {
        std::vector<Entry> out;
        for (const auto& p : bench.published) {
            if (p.port != 0) continue;
            for (std::int64_t i = 0; i < p.tracks().count; ++i) {
                const plr_tracks& t = p.tracks();
                out.push_back(
                    {t.ids[i],
                     t.times[i],
                     t.status[i],
                     t.misses[i],
                     pelorus::item(t.mean, i),
                     pelorus::item(t.covariance, i),
                     pelorus::item(t.extent, i),
                     {t.measurements + t.measurement_offsets[i], t.measurements + t.measurement_offsets[i + 1]}});
            }
        }
        return out;
    }
    /// d^2 of the centroids, in the order of the scans.
    std::vector<double> innovations() const {
        std::vector<double> out;
        for (const auto& p : bench.published)
            if (p.port == 1)
                pelorus::for_each_innovation(*p.message->body.values, [&](const pelorus::Innovation& innovation) {
                    CHECK(innovation.components == 3);
                    CHECK(innovation.time == p.message->time);
                    out.push_back(innovation.squared);
                });
        return out;
    }
};

}  // namespace extended_target
