// Recordings of an object and 15 decoys that drift apart: 16 targets tracked one by one from converted measurements, and what is
// linked of them. The recordings are found through PELORUS_DATA; without it these tests say so and pass.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "grouping_rig.hpp"

namespace {

using namespace track_then_group;
using namespace pelorus::test;
using Points = std::vector<std::array<double, 3>>;

constexpr double threshold = 500;                                     // d0, m
constexpr double range_noise = 6, angle_noise = 0.0014 * M_PI / 180;  // m, rad

std::string file_of(int seed, const std::string& what) {
    const char* data = std::getenv("PELORUS_DATA");
    const std::filesystem::path file = std::filesystem::path(data == nullptr ? "" : data) / "space_groups" /
                                       ("seed" + std::to_string(seed) + "_" + what + ".csv");
    if (data != nullptr && std::filesystem::exists(file)) return file;
    WARN("skipped: PELORUS_DATA names no folder with " << file.filename());
    return {};
}

/// By time step k, 1 to 760; rows are k,i,x,y,z.
std::map<int, Points> read(const std::string& file) {
    std::map<int, Points> steps;
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        std::array<double, 5> row{};
        std::istringstream cells(line);
        std::string cell;
        for (double& number : row) {
            std::getline(cells, cell, ',');
            number = std::stod(cell);
        }
        steps[static_cast<int>(row[0])].push_back({row[2], row[3], row[4]});
    }
    return steps;
}

/// A diag(range, azimuth, elevation variances) A' of a measurement of range, azimuth and elevation, at the point.
Eigen::Matrix3d converted_noise(const std::array<double, 3>& p) {
    const double range = std::hypot(p[0], p[1], p[2]), level = std::hypot(p[0], p[1]);
    Eigen::Matrix3d a;                               // d(x, y, z) / d(range, azimuth, elevation)
    a << p[0] / range, -p[1], -p[2] * p[0] / level,  //
        p[1] / range, p[0], -p[2] * p[1] / level,    //
        p[2] / range, 0, level;
    const Eigen::Vector3d variances(range_noise * range_noise, angle_noise * angle_noise, angle_noise * angle_noise);
    return a * variances.asDiagonal() * a.transpose();
}

/// tracker.point_target with gravity and a white acceleration of 0.02 m/s^2, as it is installed.
struct Targets {
    Bench bench;
    std::unique_ptr<StageUnderTest> tracker;
    pelorus::ScanBuilder builder{"radar", "", pelorus::position_space(3)};
    std::uint64_t measurements = 0;

    Targets() {
        const auto make = [&](const char* id, const char* with, std::vector<Instance::Part> parts = {}) {
            return std::make_shared<Instance>(bench, installed(id), with, std::move(parts));
        };
        const auto motion = make("motion.ballistic",
                                 "{axes: enu, origin: [37.5 deg, 0 deg, 0 m], acceleration: 0.02 m/s2, "
                                 "prior_velocity: 5 km/s}");
        const auto estimator =
            make("estimator.kalman", "{}",
                 {{"motion", "", motion}, {"sensors", "radar", make("sensor.position", "{noise: 6 m}")}});
        // The gate of 25.902 is the quantile of chi-square with three degrees of freedom at 0.99999.
        tracker = std::make_unique<StageUnderTest>(
            bench, installed("tracker.point_target"),
            "{gate_probability: 0.99999, maximum_speed: 9 km/s, start: three_point, start_confirm: 3, start_of: 3, "
            "misses_to_delete: 5, publish: all}",
            std::vector<Instance::Part>{{"estimator", "", estimator}});
    }
    /// Published tracks after the scan of step k.
    const plr_message& scan(int k, const Points& points) {
        builder.clear();
        for (const auto& point : points) builder.add(++measurements, point.data(), converted_noise(point).data());
        bench.published.clear();
        tracker->receive(0, builder.message(k * second));
        return *bench.published.at(0).message;
    }
};

/// Groups of noise-free positions that are linked below a distance, without memory.
std::size_t linked_groups(const Points& points, double distance) {
    std::vector<Member> members;
    for (const auto& point : points) members.push_back({members.size(), point, {}});
    return components(members.size(), near_pairs(members, distance)).size();
}

struct Course {
    std::map<int, std::size_t> groups, truth;
    double variation = 0, true_variation = 0;       // from k = 7 on
    std::map<int, std::set<std::uint64_t>> tracks;  // ids of those that live
    std::set<std::uint64_t> last_groups;
    std::map<std::uint64_t, Ids> parents;  // of all groups
    int outside = 0;  // steps with fewer groups than are apart by 1.1, or more than by 0.9 thresholds
};

Course course_of(int seed) {
    Course course;
    const std::map<int, Points> scans = read(file_of(seed, "meas")), truth = read(file_of(seed, "truth"));
    Targets targets;
    GroupingRig rig("{threshold: 500 m}");
    for (const auto& [k, points] : scans) {
        const auto answer = rig.send(targets.scan(k, points));
        course.last_groups.clear();
        for (const Entry& entry : answer.tracks) {
            if (entry.status == PLR_TRACK_DELETED) continue;
            course.tracks[k].insert(entry.id);
            course.last_groups.insert(entry.group);
        }
        for (const Entry& entry : answer.groups) course.parents[entry.id] = entry.parents;
        course.groups[k] = course.last_groups.size();
        course.truth[k] = linked_groups(truth.at(k), threshold);
        if (k < 7) continue;
        course.outside += course.groups[k] < linked_groups(truth.at(k), 1.1 * threshold) ||
                          course.groups[k] > linked_groups(truth.at(k), 0.9 * threshold);
        const auto step = [k = k](const std::map<int, std::size_t>& counts) {
            return std::abs(static_cast<double>(counts.at(k)) - static_cast<double>(counts.at(k - 1)));
        };
        course.variation += step(course.groups);
        course.true_variation += step(course.truth);
    }
    return course;
}

/// A group's ancestors, itself included.
std::set<std::uint64_t> ancestors(const Course& course, std::uint64_t group) {
    std::set<std::uint64_t> found;
    std::vector<std::uint64_t> open{group};
    while (!open.empty()) {
        const std::uint64_t next = open.back();
        open.pop_back();
        if (!found.insert(next).second) continue;
        for (const std::uint64_t parent : course.parents.at(next)) open.push_back(parent);
    }
    return found;
}

}  // namespace

TEST_CASE("A cloud that drifts apart is one group, then as many as are apart, and 16 tracks throughout",
          "[track_then_group][recording]") {
    for (const int seed : {1, 2, 3}) {
        if (file_of(seed, "meas").empty() || file_of(seed, "truth").empty()) return;
        CAPTURE(seed);
        const Course course = course_of(seed);
        // Within the first ten seconds all are within a hundred metres, and tracks may begin with points of several.
        CHECK(course.tracks.at(20).size() == 16);
        for (int k = 20; k <= 760; ++k)
            if (course.tracks.at(k) != course.tracks.at(20)) FAIL_CHECK("other tracks at " << k << " s");
        CHECK(course.groups.at(50) == 1);
        CHECK(course.groups.at(760) == 16);
        CHECK(course.variation <= 16.5);
        CHECK(course.true_variation >= 15);
        CHECK(course.outside <= 20);  // errors of tracks near the thresholds
        // All come from the first one, which still lives.
        CHECK(course.last_groups.count(1) == 1);
        for (const std::uint64_t group : course.last_groups) CHECK(ancestors(course, group).count(1) == 1);
        CHECK(course.parents.size() == 16);
    }
}
