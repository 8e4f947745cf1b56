/// A tracker with a filter of this build, and scans that a test makes by hand.
#pragma once

#include "../../../tests/fixtures/stage_bench.hpp"
#include "point_target_tracker.hpp"

namespace point_target {

constexpr std::int64_t second = 1'000'000'000;

/// One entry of a published message.
struct Entry {
    std::uint64_t id;
    std::int32_t status;
    std::int64_t time;  // ns
    double x, y;
    std::int32_t misses;
    std::vector<std::uint64_t> measurements;
};

struct Rig {
    pelorus::test::Bench bench;
    std::unique_ptr<pelorus::test::StageUnderTest> tracker;
    std::uint64_t measurements = 0;

    /// Constant velocity in the plane, seen by the sensor `radar` with a deviation of 1 m unless `sensors` says otherwise.
    explicit Rig(const std::string& with,
                 const std::string& motion = "{dimension: 2, noise: 0.01 m2/s3, prior_velocity: 10 m/s}") {
        using namespace pelorus::test;
        const auto position =
            std::make_shared<Instance>(bench, installed("sensor.position"), "{dimension: 2, noise: 1 m}");
        make(with, motion, {{"sensors", "radar", position}});
    }
    struct Spherical {};
    Rig(Spherical, const std::string& with) {
        using namespace pelorus::test;
        const auto sensor =
            std::make_shared<Instance>(bench, installed("sensor.spherical"), "{noise: [5 m, 1 mrad, 1 mrad]}");
        make(with, "{noise: 1 m2/s3, prior_velocity: 50 m/s}", {{"sensors", "radar", sensor}});
    }
    /// The filter in a slot `estimator` of another one.
    struct Inside {
        std::string id, with;
        bool takes_motion = false;
    };
    Rig(const Inside& inside, const std::string& with) {
        using namespace pelorus::test;
        const auto position =
            std::make_shared<Instance>(bench, installed("sensor.position"), "{dimension: 2, noise: 1 m}");
        make(with, "{dimension: 2, noise: 0.01 m2/s3, prior_velocity: 10 m/s}", {{"sensors", "radar", position}},
             &inside);
    }
    void make(const std::string& with, const std::string& motion, std::vector<pelorus::test::Instance::Part> parts,
              const Inside* inside = nullptr) {
        using namespace pelorus::test;
        parts.insert(parts.begin(),
                     {"motion", "", std::make_shared<Instance>(bench, installed("motion.constant_velocity"), motion)});
        auto estimator = std::make_shared<Instance>(bench, installed("estimator.kalman"), "{}", parts);
        if (inside != nullptr) {
            std::vector<Instance::Part> within{{"estimator", "", estimator}};
            if (inside->takes_motion) within.push_back(parts.front());
            estimator = std::make_shared<Instance>(bench, installed(inside->id.c_str()), inside->with, within);
        }
        tracker = std::make_unique<StageUnderTest>(bench, plugin_of<PointTargetTracker>("tracker.point_target"), with,
                                                   std::vector<Instance::Part>{{"estimator", "", estimator}});
    }

    /// A scan of places at a time in s; answers what the tracker published.
    std::vector<Entry> scan(double time, const std::vector<std::array<double, 2>>& places,
                            const std::vector<double>& times = {}, const std::string& sensor = "radar") {
        pelorus::ScanBuilder builder(sensor, "", pelorus::position_space(2));
        for (std::size_t i = 0; i < places.size(); ++i) {
            builder.add(++measurements, places[i].data());
            if (!times.empty()) builder.set_time(ns(times[i]));
        }
        return send(builder.message(ns(time)));
    }
    std::vector<Entry> send(const plr_message& message) {
        bench.published.clear();
        tracker->receive(PointTargetTracker::scans, message);
        const plr_tracks& tracks = bench.published.at(0).tracks();
        std::vector<Entry> entries;
        for (std::int64_t i = 0; i < tracks.count; ++i) {
            const auto mean = pelorus::item(tracks.mean, i);
            entries.push_back({tracks.ids[i],
                               tracks.status[i],
                               tracks.times[i],
                               mean(0, 0),
                               mean(1, 0),
                               tracks.misses[i],
                               {tracks.measurements + tracks.measurement_offsets[i],
                                tracks.measurements + tracks.measurement_offsets[i + 1]}});
        }
        return entries;
    }
    static std::int64_t ns(double time) { return std::llround(time * 1e9); }
};

}  // namespace point_target
