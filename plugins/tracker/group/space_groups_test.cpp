/// An object and 15 decoys in free flight, recorded: the number of groups against the published procedures.
///
/// The numbers come from an independent reproduction of Han and Zhou, Journal of Ordnance Equipment Engineering 41(12), 2020, on these
/// recordings: total variation of the number of groups by the raw partition, by the distance method and by the joint method.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>

#include <catch2/catch.hpp>
#include <Eigen/Geometry>

#include "group_rig.hpp"

using namespace group;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using pelorus::test::Instance;

namespace {

std::string recording(int seed, const std::string& what) {
    const char* const folder = std::getenv("PELORUS_DATA");
    return folder == nullptr ? std::string()
                             : std::string(folder) + "/space_groups/seed" + std::to_string(seed) + "_" + what + ".csv";
}

/// Positions by scan, from k = 1 on. Empty: there is no such recording here.
std::vector<std::vector<Vector3d>> scans_of(const std::string& path) {
    std::vector<std::vector<Vector3d>> scans;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::size_t k = 0, object = 0;
        Vector3d place;
        if (std::sscanf(line.c_str(), "%zu,%zu,%lf,%lf,%lf", &k, &object, &place.x(), &place.y(), &place.z()) != 5)
            throw std::runtime_error(path + ": not a row of a recording: " + line);
        scans.resize(std::max(scans.size(), k));
        scans[k - 1].push_back(place);
    }
    return scans;
}

/// R = A diag(6 m, 0.0014 deg, 0.0014 deg)^2 A', with A the unit vectors of range, azimuth and elevation at the place, the latter two
/// times what an angle moves.
Matrix3d noise_at(const Vector3d& place) {
    const double range = place.norm(), level = std::hypot(place.x(), place.y());
    const double angle = 0.0014 * std::acos(-1.0) / 180;
    const Vector3d along = place / range, across(-place.y() / level, place.x() / level, 0);
    Matrix3d root;
    root << 6 * along, level * angle * across, range * angle * along.cross(across);
    return root * root.transpose();
}

struct SpaceGroups {
    Rig rig;

    SpaceGroups(const std::string& with, const std::string& partitioner, const std::string& of_partitioner)
        : rig(Rig::Empty()) {
        using namespace pelorus::test;
        const auto part = [&](const std::string& id, const std::string& parameters, std::vector<Instance::Part> parts) {
            return std::make_shared<Instance>(rig.bench, installed(id), parameters, std::move(parts));
        };
        const auto motion =
            part("motion.ballistic",
                 "{axes: enu, origin: [37.5 deg, 0 deg, 0 m], integration: held, maneuver_rate: "
                 "0.016666666666666666 1/s, noise_over_extent: 0.001 1/s2, prior_acceleration: 0.1 m/s2}",
                 {});
        const auto radar = part("sensor.position", "{noise: 60 m}", {});
        rig.make(with, {{"estimator", "",
                         part("estimator.kalman", "{}", {{"motion", "", motion}, {"sensors", "radar", radar}})},
                        {"extent", "", part("extent.group_random_matrix", "{evolution: printed}", {})},
                        {"partitioner", "", part(partitioner, of_partitioner, {})}});
    }

    /// How many groups live after a scan.
    int after(std::size_t k, const std::vector<Vector3d>& places) {
        pelorus::ScanBuilder builder("radar", "", pelorus::position_space(3));
        for (const Vector3d& place : places) {
            const Matrix3d noise = noise_at(place);
            builder.add(++rig.measurements, place.data(), noise.data());
        }
        int alive = 0;
        for (const Entry& entry : rig.send(builder.message(static_cast<std::int64_t>(k) * second)))
            alive += entry.status == PLR_TRACK_DELETED ? 0 : 1;
        return alive;
    }
};

struct Counts {
    std::vector<int> alive;
    int total_variation() const {
        int sum = 0;
        for (std::size_t k = 7; k <= 760; ++k) sum += std::abs(alive[k - 1] - alive[k - 2]);
        return sum;
    }
};

Counts run(SpaceGroups&& groups, const std::vector<std::vector<Vector3d>>& scans) {
    Counts counts;
    for (std::size_t k = 1; k <= scans.size(); ++k) counts.alive.push_back(groups.after(k, scans[k - 1]));
    return counts;
}

}  // namespace

TEST_CASE("tracker.group: groups of the recorded flights split as the published procedures split them",
          "[tracker.group][space_groups]") {
    const std::string published = "{maximum_speed: 9 km/s, duplicate_distance: 0 m";
    const auto seed = GENERATE(1, 2, 3);
    const auto scans = scans_of(recording(seed, "meas"));
    if (scans.empty()) {
        WARN("there are no recordings (PELORUS_DATA): not tried");
        return;
    }
    REQUIRE(scans.size() == 760);
    const int of_distance[] = {39, 33, 35}, of_joint[] = {15, 15, 17};
    const Counts distance = run({published + "}", "partitioner.distance", "{threshold: 500 m}"}, scans);
    const Counts joint =
        run({published + ", start_gate_probability: 0.9999}", "partitioner.joint", "{threshold: 500 m}"}, scans);
    INFO("seed " << seed);
    CHECK(std::abs(distance.total_variation() - of_distance[seed - 1]) <= 3);
    CHECK(std::abs(joint.total_variation() - of_joint[seed - 1]) <= 1);
    for (const Counts* counts : {&distance, &joint}) {
        CHECK(counts->alive[49] <= 2);
        CHECK(counts->alive[759] >= 16);
        CHECK(counts->alive[759] <= 17);
    }
}

TEST_CASE("tracker.group: with missed detections no ghosts are left where duplicates are removed",
          "[tracker.group][space_groups]") {
    const auto scans = scans_of(recording(1, "meas"));
    if (scans.empty()) {
        WARN("there are no recordings (PELORUS_DATA): not tried");
        return;
    }
    // Each point is there nine times of ten.
    std::mt19937 random(5);
    std::vector<std::vector<Vector3d>> seen;
    for (const auto& scan : scans) {
        auto& some = seen.emplace_back();
        for (const Vector3d& place : scan)
            if (random() % 10 != 0) some.push_back(place);
    }
    const Counts counts = run({"{maximum_speed: 9 km/s, start_gate_probability: 0.9999, duplicate_distance: 20 m}",
                               "partitioner.joint", "{threshold: 500 m}"},
                              seen);
    for (std::size_t k = 661; k <= 760; ++k) CHECK(counts.alive[k - 1] == 16);
}
