/// Two sensors that see the same targets, one of them mounted and timed wrongly, and the stage that is to find out. What they
/// measure is computed here, not by the sensor models.
#pragma once

#include <cmath>
#include <functional>
#include <random>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "calibration_stage.hpp"

namespace calibration {

constexpr std::int64_t second = 1'000'000'000;
using Path = std::function<Eigen::Vector3d(double)>;

/// About the vertical, at a rate in rad/s and a distance in m, rising: seen from the origin under all azimuths.
inline Path circle(double rate = 0.02, double distance = 1000, double height = 600) {
    return [=](double t) {
        return Eigen::Vector3d(distance * std::cos(rate * t), distance * std::sin(rate * t), height + 1.5 * t);
    };
}

struct World {
    std::vector<Path> targets{circle()};
    BiasVector biases = BiasVector::Zero();  ///< the true ones
    Eigen::Vector3d radar_sd{5, 3e-3, 3e-3}, eo_sd{5, 1e-5, 1e-5};
    bool is_passive = false;
    double radar_period = 2, eo_period = 0.05;  // s
    unsigned seed = 1;
};

inline Eigen::Vector3d spherical_of(const Eigen::Vector3d& p) {
    return {p.norm(), std::atan2(p.y(), p.x()), std::atan2(std::hypot(p.x(), p.y()), p.z())};
}

class Rig {
public:
    pelorus::test::Bench bench;
    std::unique_ptr<pelorus::test::StageUnderTest> stage;
    World world;

    Rig(const World& given, const std::string& with) : world(given), random_(given.seed) {
        using namespace pelorus::test;
        const std::string mount = "position: [10 m, 5 m, 3 m], attitude: [-1 deg, 2 deg, -3 deg], angle: zenith";
        const auto radar = std::make_shared<Instance>(bench, installed("sensor.spherical"),
                                                      "{noise: [5 m, 3 mrad, 3 mrad], angle: zenith}");
        const auto eo = std::make_shared<Instance>(
            bench, installed(world.is_passive ? "sensor.bearings" : "sensor.spherical"), "{" + mount + "}");
        stage = std::make_unique<StageUnderTest>(
            bench, plugin_of<CalibrationStage>("registration.calibration"), with,
            std::vector<Instance::Part>{{"sensors", "radar", radar}, {"sensors", "eo", eo}});
    }

    const CalibrationStage& calibration() const {
        return *static_cast<const CalibrationStage*>(stage->instance().self());
    }
    const Biases& biases() const { return calibration().biases(); }

    /// Both sensors from `from` (exclusive) to `to`, in s.
    void run(double from, double to) {
        const auto first = std::llround(from / world.eo_period) + 1, last = std::llround(to / world.eo_period);
        const auto ratio = std::llround(world.radar_period / world.eo_period);
        for (auto i = first; i <= last; ++i) {
            const double t = static_cast<double>(i) * world.eo_period;
            if (i % ratio == 0) radar(t);
            eo(t);
        }
    }
    void radar(double t) { receive(radar_scan(t), t); }
    void eo(double t) { receive(eo_scan(t), t + world.biases(clock_offset)); }
    void receive(pelorus::ScanBuilder builder, double stamp) {
        stage->receive(CalibrationStage::scans_in, builder.message(std::llround(stamp * 1e9)));
    }
    pelorus::ScanBuilder radar_scan(double t) {
        pelorus::ScanBuilder builder("radar", "", space(false));
        for (const Path& target : world.targets) add(builder, spherical_of(target(t)), world.radar_sd, false);
        return builder;
    }
    /// What it measures at t; its clock then shows t + offset.
    pelorus::ScanBuilder eo_scan(double t) {
        pelorus::ScanBuilder builder("eo", "", space(world.is_passive));
        for (const Path& target : world.targets)
            add(builder, seen_by_eo(target(t), world.biases), world.eo_sd, world.is_passive);
        return builder;
    }
    Eigen::Vector3d seen_by_eo(const Eigen::Vector3d& p, const BiasVector& b) const {
        const auto turn = [](double about_x, double about_y, double about_z) {
            Eigen::Matrix3d x, y, z;
            x << 1, 0, 0, 0, std::cos(about_x), -std::sin(about_x), 0, std::sin(about_x), std::cos(about_x);
            y << std::cos(about_y), 0, std::sin(about_y), 0, 1, 0, -std::sin(about_y), 0, std::cos(about_y);
            z << std::cos(about_z), -std::sin(about_z), 0, std::sin(about_z), std::cos(about_z), 0, 0, 0, 1;
            return Eigen::Matrix3d(z * y * x);
        };
        const double degree = std::acos(-1.0) / 180;
        const Eigen::Matrix3d mount = turn(-degree, 2 * degree, -3 * degree) * turn(b(roll), b(pitch), b(yaw));
        Eigen::Vector3d z = spherical_of(mount.transpose() * (p - Eigen::Vector3d(10, 5, 3) - b.segment<3>(offset_x)));
        z(0) += b(range_bias);
        return z;
    }

private:
    static pelorus::Space space(bool is_passive) {
        const pelorus::Component range{"range", "m", 0, 0, false}, azimuth{"azimuth", "rad", 0, 0, true},
            zenith{"zenith", "rad", 0, 0, true};
        return is_passive ? pelorus::Space({azimuth, zenith}) : pelorus::Space({range, azimuth, zenith});
    }
    void add(pelorus::ScanBuilder& builder, Eigen::Vector3d z, const Eigen::Vector3d& sd, bool is_passive) {
        for (int c = 0; c < 3; ++c) z(c) += sd(c) * normal_(random_);
        const Eigen::Vector3d variances = sd.cwiseAbs2();
        const int skip = is_passive ? 1 : 0;
        const Eigen::MatrixXd covariance = variances.tail(3 - skip).asDiagonal();
        builder.add(++ids_, z.data() + skip, covariance.data());
    }

    std::mt19937_64 random_;
    std::normal_distribution<double> normal_;
    std::uint64_t ids_ = 0;
};

inline World wrong(int bias, double by) {
    World world;
    world.biases(bias) = by;
    return world;
}

/// Sensors that tell all of it: a reference of 1 m and 0.2 mrad.
inline World precise() {
    World world;
    world.radar_sd = {1, 2e-4, 2e-4};
    world.eo_sd = {1, 1e-5, 1e-5};
    world.targets = {circle(0.05, 800, 300), circle(-0.08, 400, 500)};
    return world;
}

}  // namespace calibration
