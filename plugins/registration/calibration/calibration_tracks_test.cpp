#include <catch2/catch.hpp>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "calibration_rig.hpp"

using namespace calibration;

namespace {

/// One track of position and velocity, through the stage; answers its mean and covariance.
std::pair<Eigen::VectorXd, Eigen::MatrixXd> through(Rig& rig, const Eigen::VectorXd& mean,
                                                    const Eigen::MatrixXd& covariance) {
    pelorus::TracksBuilder builder("", pelorus::kinematic_space(3, {1, 1}), 3);
    pelorus::TrackEntry entry;
    entry.id = 1;
    entry.mean = mean.data();
    entry.covariance = covariance.data();
    const Eigen::MatrixXd extent = Eigen::Vector3d(9, 4, 1).asDiagonal();
    entry.extent = extent.data();
    builder.add(entry);
    rig.bench.published.clear();
    rig.stage->receive(CalibrationStage::tracks_in, builder.message(second));
    REQUIRE(rig.bench.published.size() == 1);
    REQUIRE(rig.bench.published[0].port == CalibrationStage::tracks_out);
    const plr_tracks& tracks = rig.bench.published[0].tracks();
    const Eigen::MatrixXd turned = pelorus::item(tracks.extent, 0);
    CHECK(turned.trace() == Approx(14));  // as large as before
    return {pelorus::item(tracks.mean, 0), pelorus::item(tracks.covariance, 0)};
}

/// Where a sensor that is believed to be right sees what the wrong one sees: a direction and a range from its mount.
Eigen::Vector3d believed_place(const Rig& rig, const Eigen::Vector3d& place, const BiasVector& biases) {
    const Eigen::Vector3d wanted = rig.seen_by_eo(place, biases);
    Eigen::Vector3d at = place;  // by Newton's method with differences
    for (int pass = 0; pass < 8; ++pass) {
        Eigen::Matrix3d slope;
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d step = 0.01 * Eigen::Vector3d::Unit(axis);
            slope.col(axis) =
                (rig.seen_by_eo(at + step, BiasVector::Zero()) - rig.seen_by_eo(at - step, BiasVector::Zero())) / 0.02;
        }
        at += Eigen::Matrix3d(slope).fullPivLu().solve(wanted - rig.seen_by_eo(at, BiasVector::Zero()));
    }
    return at;
}

}  // namespace

TEST_CASE("calibration: tracks of the world as the sensor sees it are moved to where things are", "[registration]") {
    World world = precise();
    world.biases << 3e-3, -2e-3, 4e-3, 1, -2, 0.5, 0, 0;
    world.radar_sd = {0.01, 1e-6, 1e-6};
    world.eo_sd = {0.01, 1e-7, 1e-7};
    Rig rig(world, "{correct: tracks, attitude_sd: 5 mrad, position_sd: 3 m, presence: 1, maximum_speed: 60 m/s}");
    rig.run(0, 200);
    const Eigen::Vector3d place(300, -700, 450), velocity(20, -5, 3);
    Eigen::VectorXd mean(6);
    const double dt = 0.1;
    const Eigen::Vector3d seen = believed_place(rig, place, world.biases),
                          later = believed_place(rig, place + dt * velocity, world.biases);
    mean << seen, (later - seen) / dt;
    CHECK((seen - place).norm() > 2);
    const auto [moved, covariance] = through(rig, mean, Eigen::MatrixXd::Identity(6, 6));
    CHECK((moved.head<3>() - place).norm() < 0.05);
    CHECK((moved.tail<3>() - velocity).norm() < 1e-3);
    CHECK((covariance - Eigen::MatrixXd::Identity(6, 6)).norm() < 0.05);
    // The measurements are left as they are.
    rig.bench.published.clear();
    pelorus::ScanBuilder sent = rig.eo_scan(201);
    rig.receive(sent, 201);
    CHECK(pelorus::item(rig.bench.published.front().scan().measurements, 0) ==
          pelorus::item(sent.message(0).body.scan->measurements, 0));
}

TEST_CASE("calibration: what is not known of a turn widens tracks across the line of sight", "[registration]") {
    const std::string more = GENERATE("", ", mode: schmidt", ", covariance: kept");
    Rig rig(World{}, "{correct: tracks, attitude_sd: [0 rad, 0 rad, 1 mrad], presence: 1" + more + "}");
    rig.radar(2);
    Eigen::VectorXd mean(6);
    mean << 2010, 5, 3, 0, 0, 0;  // 2 km along x from the sensor
    const auto [moved, covariance] = through(rig, mean, Eigen::MatrixXd::Identity(6, 6));
    CHECK((moved - mean).norm() < 1e-9);
    const double across = more == ", covariance: kept" ? 0 : 4;  // (1 mrad times 2 km)^2, a mount tilted by 2 deg
    CHECK(covariance(1, 1) - 1 == Approx(across).epsilon(0.01));
    CHECK(covariance(0, 0) - 1 == Approx(0).margin(0.02));
}

TEST_CASE("calibration: tracks pass where measurements are corrected, and where nothing is wrong", "[registration]") {
    const std::string with = GENERATE("{attitude_sd: 1 mrad}", "{correct: tracks}");
    Rig rig(wrong(yaw, 1e-3), with);
    rig.run(0, 100);
    const Eigen::VectorXd mean = Eigen::VectorXd::LinSpaced(6, 100, 600);
    const auto [moved, covariance] = through(rig, mean, Eigen::MatrixXd::Identity(6, 6));
    CHECK(moved == mean);
    CHECK(covariance == Eigen::MatrixXd::Identity(6, 6));
}
