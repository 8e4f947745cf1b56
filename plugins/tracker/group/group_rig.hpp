/// The tracker with everything in its slots, scans that a test makes by hand, and partitioners whose answers are plain to see.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <pelorus/batch_model.hpp>
#include <pelorus/innovations.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "group_tracker.hpp"

namespace group {

constexpr std::int64_t second = 1'000'000'000;

/// Members of cells as lists of points; what a test's partitioner answers.
struct TestCell {
    std::int64_t prediction;
    std::vector<std::int64_t> members;
    std::vector<double> weights;
};

inline plr_status answer(const std::vector<TestCell>& cells, plr_partition& out) {
    out.alternatives = cells.empty() ? 0 : 1;
    out.cells = static_cast<std::int64_t>(cells.size());
    out.members = 0;
    for (const TestCell& cell : cells) out.members += static_cast<std::int64_t>(cell.members.size());
    if (out.cells > out.cell_capacity || out.members > out.member_capacity) return PLR_E_CAPACITY;
    out.alternative_offsets[0] = out.cell_offsets[0] = 0;
    if (cells.empty()) return PLR_OK;
    out.alternative_offsets[1] = out.cells;
    out.alternative_weights[0] = 1;
    std::int64_t member = 0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        for (std::size_t k = 0; k < cells[c].members.size(); ++k) {
            out.member_points[member] = cells[c].members[k];
            out.member_weights[member++] =
                cells[c].weights.empty() ? 1.0 / static_cast<double>(cells[c].members.size()) : cells[c].weights[k];
        }
        out.cell_predictions[c] = cells[c].prediction;
        out.cell_offsets[c + 1] = member;
    }
    return PLR_OK;
}

/// Connected components of |a - b| < threshold among points that are not taken, by looking at all pairs.
inline std::vector<TestCell> components(const plr_const_view& points, double threshold, std::vector<bool> is_taken) {
    std::vector<TestCell> cells;
    for (std::int64_t first = 0; first < points.count; ++first) {
        if (is_taken[static_cast<std::size_t>(first)]) continue;
        std::vector<std::int64_t> members{first};
        is_taken[static_cast<std::size_t>(first)] = true;
        for (std::size_t k = 0; k < members.size(); ++k)
            for (std::int64_t j = 0; j < points.count; ++j) {
                if (is_taken[static_cast<std::size_t>(j)] ||
                    !((pelorus::item(points, members[k]) - pelorus::item(points, j)).norm() < threshold))
                    continue;
                is_taken[static_cast<std::size_t>(j)] = true;
                members.push_back(j);
            }
        std::sort(members.begin(), members.end());
        cells.push_back({-1, members, {}});
    }
    return cells;
}

/// Splits by distance; the input `threshold` takes the place of the parameter where it is above 0.
struct ByDistance : pelorus::Partitioner<ByDistance> {
    double threshold = 0;
    static void describe(pelorus::Describe<ByDistance>& plugin) {
        plugin.parameter("threshold", &ByDistance::threshold).unit("m").initially("50 m").above(0).doc("d0");
        plugin.input("threshold", "m", {0}, "d0");
    }
    void setup(const pelorus::Setup&) {
        info.dimension_min = 1;
        info.dimension_max = 3;
    }
    plr_status split(const plr_call& call, const plr_partitioner_split& args) const {
        const double given = *inputs(call, 0, 0);
        const std::vector<bool> none(static_cast<std::size_t>(args.points.count), false);
        return answer(components(args.points, given > 0 ? given : threshold, none), *args.out);
    }
};

/// What is within 60 m of a prediction is its cell, whoever else has it; weights 2 : 1 : 1 ... by distance. The rest by distance of 50 m.
struct AboutPredictions : pelorus::Partitioner<AboutPredictions> {
    static void describe(pelorus::Describe<AboutPredictions>& plugin) { plugin.flags(PLR_DESCRIPTION_OVERLAP); }
    void setup(const pelorus::Setup&) {
        info.dimension_min = 1;
        info.dimension_max = 3;
    }
    plr_status split(const plr_call&, const plr_partitioner_split& args) const {
        std::vector<bool> is_taken(static_cast<std::size_t>(args.points.count), false);
        std::vector<TestCell> cells;
        for (std::int64_t p = 0; p < args.predictions.count; ++p) {
            TestCell cell{p, {}, {}};
            double nearest = 60;
            std::size_t best = 0;
            for (std::int64_t k = 0; k < args.points.count; ++k) {
                const double away = (pelorus::item(args.points, k) - pelorus::item(args.predictions.mean, p)).norm();
                if (!(away < 60)) continue;
                if (away < nearest) best = cell.members.size();
                nearest = std::min(nearest, away);
                is_taken[static_cast<std::size_t>(k)] = true;
                cell.members.push_back(k);
            }
            if (cell.members.empty()) continue;
            cell.weights.assign(cell.members.size(), 1.0 / static_cast<double>(cell.members.size() + 1));
            cell.weights[best] *= 2;
            cells.push_back(cell);
        }
        for (const TestCell& cell : components(args.points, 50, is_taken)) cells.push_back(cell);
        return answer(cells, *args.out);
    }
};

/// One entry of a published message.
struct Entry {
    std::uint64_t id;
    std::int32_t status, misses;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance, extent;
    std::vector<std::uint64_t> parents, measurements;
};

inline std::vector<Entry> entries_of(const plr_tracks& t) {
    std::vector<Entry> out;
    for (std::int64_t i = 0; i < t.count; ++i)
        out.push_back({t.ids[i],
                       t.status[i],
                       t.misses[i],
                       pelorus::item(t.mean, i),
                       pelorus::item(t.covariance, i),
                       pelorus::item(t.extent, i),
                       {t.parents + t.parent_offsets[i], t.parents + t.parent_offsets[i + 1]},
                       {t.measurements + t.measurement_offsets[i], t.measurements + t.measurement_offsets[i + 1]}});
    return out;
}

using Place = std::array<double, 3>;

/// Groups that move at a constant velocity, seen by the sensor `radar` as positions.
struct Rig {
    using Instance = pelorus::test::Instance;
    pelorus::test::Bench bench;
    std::unique_ptr<pelorus::test::StageUnderTest> tracker;
    std::uint64_t measurements = 0;
    double variance = 4;  ///< of the measurements, m2

    static constexpr const char* slow = "{maximum_speed: 100 m/s, duplicate_distance: 0 m}";

    explicit Rig(const std::string& with = slow, const plr_plugin* partitioner = nullptr) {
        const auto motion = std::make_shared<Instance>(bench, pelorus::test::installed("motion.constant_velocity"),
                                                       "{noise: 0.1 m2/s3, prior_velocity: 20 m/s}");
        const auto radar =
            std::make_shared<Instance>(bench, pelorus::test::installed("sensor.position"), "{noise: 2 m}");
        const std::vector<Instance::Part> inner{{"motion", "", motion}, {"sensors", "radar", radar}};
        const auto extent = std::make_shared<Instance>(bench, pelorus::test::installed("extent.group_random_matrix"),
                                                       "{smallest_half_axis: 3 m}");
        const auto splits = std::make_shared<Instance>(bench, partitioner != nullptr ? *partitioner : by_distance());
        make(with, {{"estimator", "",
                     std::make_shared<Instance>(bench, pelorus::test::installed("estimator.kalman"), "{}", inner)},
                    {"extent", "", extent},
                    {"partitioner", "", splits}});
    }
    /// Without a tracker yet, see make.
    struct Empty {};
    explicit Rig(Empty) {}

    static const plr_plugin& by_distance() {
        return pelorus::test::plugin_of<ByDistance>("org.example.partitioner.by_distance");
    }
    static const plr_plugin& about_predictions() {
        return pelorus::test::plugin_of<AboutPredictions>("org.example.partitioner.about_predictions");
    }

    void make(const std::string& with, const std::vector<Instance::Part>& parts) {
        tracker = std::make_unique<pelorus::test::StageUnderTest>(
            bench, pelorus::test::plugin_of<GroupTracker>("tracker.group"), with, parts);
    }

    /// Places seen at second k, each with covariance `variance` I; answers what the tracker told.
    std::vector<Entry> scan(int k, const std::vector<Place>& places) {
        pelorus::ScanBuilder builder("radar", "", pelorus::position_space(3));
        const Eigen::Matrix3d noise = variance * Eigen::Matrix3d::Identity();
        for (const Place& place : places) builder.add(++measurements, place.data(), noise.data());
        return send(builder.message(k * second));
    }
    std::vector<Entry> send(const plr_message& message) {
        bench.published.clear();
        tracker->receive(GroupTracker::scans, message);
        for (const auto& published : bench.published)
            if (published.port == GroupTracker::tracks) return entries_of(published.tracks());
        return {};
    }
    /// d^2 told with the last scan, in the order of the groups.
    std::vector<double> innovations() const {
        std::vector<double> out;
        for (const auto& published : bench.published)
            if (published.port == GroupTracker::innovations)
                pelorus::for_each_innovation(
                    *published.message->body.values,
                    [&](const pelorus::Innovation& innovation) { out.push_back(innovation.squared); });
        return out;
    }
};

/// A group of four on a square of 20 m about a centre.
inline std::vector<Place> square(double x, double y) {
    return {{x - 10, y - 10, 0}, {x + 10, y - 10, 0}, {x - 10, y + 10, 0}, {x + 10, y + 10, 0}};
}
inline std::vector<Place> both(std::vector<Place> a, const std::vector<Place>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

}  // namespace group
