#include <cmath>

#include <catch2/catch.hpp>
#include <Eigen/Eigenvalues>

#include "../../../tests/support/airship_parts.hpp"
#include "rigid_registration.hpp"

namespace {

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using rigid::RigidRegistration;

const char* const of_paper = "attitude: [-1 deg, 2 deg, -3 deg], translation: [10 m, 5 m, 3 m]";
const double degree = std::acos(-1.0) / 180;

/// A registration of a sensor `radar` and what comes out of it.
struct Rig {
    Bench bench;
    std::unique_ptr<StageUnderTest> stage;
    std::uint64_t next_id = 1;

    Rig(const std::string& with, const std::string& moved, const std::string& moved_with, const std::string& as = "",
        const std::string& as_with = "{}", const std::string& frame = "eo") {
        std::vector<Part> parts{{"moved", "radar", part(bench, "sensor", moved, moved_with)}};
        if (!as.empty()) parts.push_back({"as", "", part(bench, "sensor", as, as_with)});
        parts.push_back({"local", "eo", part(bench, "sensor", "bearings", "{angle: zenith}")});
        stage = std::make_unique<StageUnderTest>(
            bench, pelorus::test::plugin_of<RigidRegistration>("registration.rigid"), with, parts, frame);
    }

    const plr_scan& scan(const pelorus::Space& space, const VectorXd& z, const MatrixXd& noise,
                         const std::string& sensor = "radar", const std::string& frame = "") {
        pelorus::ScanBuilder builder(sensor, frame, space);
        builder.add(next_id++, z.data(), noise.size() == 0 ? nullptr : noise.data());
        stage->receive(RigidRegistration::scans_in, builder.message(second));
        return bench.published.back().scan();
    }
};

pelorus::Space spherical_space() {
    return pelorus::Space({{"range", "m"}, {"azimuth", "rad", 0, 0, true}, {"zenith", "rad", 0, 0, true}});
}
VectorXd seen(const VectorXd& p) {
    VectorXd z(3);
    z << p.norm(), std::atan2(p(1), p(0)), std::acos(p(2) / p.norm());
    return z;
}
VectorXd point_of(const VectorXd& z) {
    VectorXd p(3);
    p << std::cos(z(1)) * std::sin(z(2)), std::sin(z(1)) * std::sin(z(2)), std::cos(z(2));
    return z(0) * p;
}
MatrixXd radar_noise() {
    VectorXd variances(3);
    variances << 25, 9e-6, 9e-6;
    return variances.asDiagonal();
}
VectorXd fix() {
    VectorXd p(3);
    p << 950, 1250, 1050;
    return p;
}
MatrixXd published_rotation() {
    MatrixXd c(3, 3);
    c << .998021, -.052304, -.034899, .051720, .998509, -.017442, .035760, .015602, .999239;
    return c;
}

}  // namespace

TEST_CASE("rigid registration: a fix of the radar is told along the axes of the electro-optical head",
          "[registration]") {
    const bool is_kept = GENERATE(true, false);
    Rig rig(std::string("{") + of_paper + (is_kept ? ", covariance: kept}" : "}"), "spherical", "{angle: zenith}",
            "spherical", "{angle: zenith}");
    const plr_scan& told = rig.scan(spherical_space(), seen(fix()), radar_noise());
    CHECK(std::string(told.frame) == "eo");
    CHECK(std::string(told.sensor) == "radar");
    CHECK(told.ids[0] == 1);
    Eigen::Vector3d site(10, 5, 3);
    const VectorXd expected = seen(published_rotation() * (fix() - site));
    const VectorXd z = pelorus::item(told.measurements, 0);
    CHECK(z(0) == Approx(expected(0)).margin(1e-2));
    CHECK((z - expected).tail(2).norm() < 2e-6);  // the matrix has six digits
    const MatrixXd noise = pelorus::item(told.covariances, 0);
    if (is_kept) {
        CHECK(noise == radar_noise());
        return;
    }
    // By differences of the whole way, in closed form.
    const MatrixXd c = rigid::rotation_of_attitude({-degree, 2 * degree, -3 * degree}).transpose();
    MatrixXd slope(3, 3);
    const double steps[] = {1e-2, 1e-6, 1e-6};
    for (int k = 0; k < 3; ++k) {
        VectorXd up = seen(fix()), down = up;
        up(k) += steps[k];
        down(k) -= steps[k];
        slope.col(k) = (seen(c * (point_of(up) - site)) - seen(c * (point_of(down) - site))) / (2 * steps[k]);
    }
    const MatrixXd moved = slope * radar_noise() * slope.transpose();
    const VectorXd scale = moved.diagonal().cwiseSqrt().cwiseInverse();
    CHECK((scale.asDiagonal() * (noise - moved) * scale.asDiagonal()).cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("rigid registration: there and back is where it was", "[registration]") {
    const std::string as = GENERATE("spherical", "position");
    Rig there(std::string("{") + of_paper + "}", "spherical", "{angle: zenith}", as,
              as == "spherical" ? "{angle: zenith}" : "{}");
    Rig back(std::string("{") + of_paper + ", direction: inverse}", as, as == "spherical" ? "{angle: zenith}" : "{}",
             "spherical", "{angle: zenith}");
    for (int k = 0; k < 20; ++k) {
        VectorXd z(3);
        z << 200 + 300 * k, -3 + 0.3 * k, 0.2 + 0.13 * k;
        const plr_scan& middle = there.scan(spherical_space(), z, radar_noise());
        const MatrixXd between = pelorus::item(middle.covariances, 0);
        CHECK(between == between.transpose());
        CHECK(Eigen::SelfAdjointEigenSolver<MatrixXd>(between).eigenvalues()(0) > 0);
        const plr_scan& end = back.scan(pelorus::Space(*middle.space), pelorus::item(middle.measurements, 0), between);
        const VectorXd again = pelorus::item(end.measurements, 0);
        CHECK(again(0) == Approx(z(0)).epsilon(1e-12));
        CHECK((again - z).tail(2).norm() < 1e-12);
        const MatrixXd noise = pelorus::item(end.covariances, 0);
        CHECK(noise == noise.transpose());
        CHECK((noise - radar_noise()).cwiseAbs().maxCoeff() < 1e-8);
    }
}

TEST_CASE("rigid registration: without parameters the frames of the config tell the motion", "[registration]") {
    Rig by_frames("{}", "position", "{}"), by_parameters(std::string("{") + of_paper + "}", "position", "{}");
    const auto c = rigid::rotation_of_attitude({-degree, 2 * degree, -3 * degree});
    const double site[] = {10, 5, 3};
    by_frames.bench.frames.add_local("eo", "", c.data(), site);
    const pelorus::Space space = pelorus::position_space(3);
    const VectorXd one = pelorus::item(by_frames.scan(space, fix(), radar_noise()).measurements, 0);
    const VectorXd other = pelorus::item(by_parameters.scan(space, fix(), radar_noise()).measurements, 0);
    CHECK((one - other).norm() < 1e-9);
    CHECK((one - fix()).norm() > 1);
    CHECK_THROWS_WITH(by_frames.scan(space, fix(), radar_noise(), "radar", "nowhere"), Catch::Contains("nowhere"));
}

TEST_CASE("rigid registration: sites by parameters are sites by frames", "[registration]") {
    const std::string sites = "from_site: [43.1 deg, 5.9 deg, 12 m], to_site: [43.5 deg, 6.4 deg, 900 m]";
    Rig by_parameters("{" + sites + "}", "position", "{}"), by_frames("{}", "position", "{}"),
        back("{" + sites + ", direction: inverse}", "position", "{}");
    by_frames.bench.frames.add_geodetic("radar", 43.1 * degree, 5.9 * degree, 12);
    by_frames.bench.frames.add_geodetic("eo", 43.5 * degree, 6.4 * degree, 900);
    const pelorus::Space space = pelorus::position_space(3);
    VectorXd far(3);
    far << 41e3, 45e3, 2e3;
    const plr_scan& told = by_parameters.scan(space, far, radar_noise());
    const plr_scan& expected = by_frames.scan(space, far, radar_noise(), "radar", "radar");
    const VectorXd there = pelorus::item(told.measurements, 0);
    const MatrixXd noise = pelorus::item(told.covariances, 0);
    CHECK((there - pelorus::item(expected.measurements, 0)).norm() < 1e-6);
    CHECK((noise - pelorus::item(expected.covariances, 0)).norm() < 1e-9);
    CHECK(there.norm() < 5e3);  // over the other site, half a degree away
    CHECK((VectorXd(pelorus::item(back.scan(space, there, noise).measurements, 0)) - far).norm() < 1e-8);
}

TEST_CASE("rigid registration: what stands along the new axes keeps its values, other sensors keep all",
          "[registration]") {
    Rig rig(std::string("{") + of_paper + "}", "spherical", "{angle: zenith}");
    const pelorus::Space bearings({{"azimuth", "rad", 0, 0, true}, {"zenith", "rad", 0, 0, true}});
    VectorXd z(2);
    z << 0.3, 1.2;
    const MatrixXd noise = 1e-10 * MatrixXd::Identity(2, 2);
    const plr_scan& local = rig.scan(bearings, z, noise, "eo");
    CHECK(std::string(local.frame) == "eo");
    CHECK(VectorXd(pelorus::item(local.measurements, 0)) == z);
    CHECK(MatrixXd(pelorus::item(local.covariances, 0)) == noise);
    const plr_scan& other = rig.scan(bearings, z, noise, "sonar", "sea");
    CHECK(std::string(other.frame) == "sea");
    CHECK(VectorXd(pelorus::item(other.measurements, 0)) == z);
    CHECK_THROWS_WITH(
        rig.scan(bearings, z, noise, "radar"),
        "sensor radar measures range [m], azimuth [rad], zenith [rad], its scan has azimuth [rad], zenith [rad]");
}

TEST_CASE("rigid registration: a local sensor that stands elsewhere than the new axes is refused", "[registration]") {
    const pelorus::Space angles({{"azimuth", "rad", 0, 0, true}, {"zenith", "rad", 0, 0, true}});
    const auto told = [&](const std::string& mount) {
        Bench bench;
        std::vector<Part> parts{{"local", "eo", part(bench, "sensor", "bearings", "{angle: zenith, " + mount + "}")}};
        StageUnderTest stage(bench, pelorus::test::plugin_of<RigidRegistration>("registration.rigid"),
                             std::string("{") + of_paper + "}", parts, "head");
        pelorus::ScanBuilder builder("eo", "", angles);
        const double z[] = {0.5, 1.2}, noise[] = {1e-10, 0, 0, 1e-10};
        builder.add(1, z, noise);
        stage.receive(RigidRegistration::scans_in, builder.message(second));
        return std::string(bench.published.back().scan().frame);
    };
    CHECK(told("") == "head");  // along the new axes already
    CHECK(told("position: [10 m, 5 m, 3 m], attitude: [-1 deg, 2 deg, -3 deg]") == "head");  // where the new axes stand
    CHECK_THROWS_WITH(told("position: [10 m, 5 m, 3 m], attitude: [-1 deg, 2 deg, 0 deg]"),
                      Catch::Contains("has eo, whose position and attitude are not those of frame head"));
}

TEST_CASE("rigid registration: a scan without covariances has the sensor's own noise", "[registration]") {
    Rig rig(std::string("{") + of_paper + "}", "spherical", "{angle: zenith, noise: [5 m, 3 mrad, 3 mrad]}");
    const MatrixXd own = pelorus::item(rig.scan(spherical_space(), seen(fix()), MatrixXd()).covariances, 0);
    const MatrixXd told = pelorus::item(rig.scan(spherical_space(), seen(fix()), radar_noise()).covariances, 0);
    CHECK((own - told).norm() < 1e-9 * told.norm());
}

TEST_CASE("rigid registration: a measurement that has no derivative is left out, the others go on", "[registration]") {
    Rig rig("{translation: [0 m, 0 m, 0 m]}", "position", "{}", "spherical", "{angle: zenith}");
    pelorus::ScanBuilder builder("radar", "", pelorus::position_space(3));
    const MatrixXd noise = MatrixXd::Identity(3, 3);
    const double above[] = {0, 0, 100}, aside[] = {100, 0, 0};
    builder.add(7, above, noise.data());
    builder.set_time(second);
    builder.add(8, aside, noise.data());
    builder.set_time(second + 1);
    rig.stage->receive(RigidRegistration::scans_in, builder.message(second));
    const plr_scan& told = rig.bench.published.back().scan();
    REQUIRE(told.measurements.count == 1);
    CHECK(told.ids[0] == 8);
    CHECK(told.times[0] == second + 1);
    CHECK(rig.bench.counters.at("measurements_not_moved") == 1);
}

TEST_CASE("rigid registration: velocities and extents of tracks turn and do not shift", "[registration]") {
    Rig rig("{attitude: [0 deg, 0 deg, 90 deg], translation: [10 m, 0 m, 0 m]}", "position", "{}");
    pelorus::TracksBuilder builder("", pelorus::kinematic_space(3, {1, 1, 1}), 3);
    VectorXd mean(9), variances(9);
    mean << 30, 40, 5, 1, 2, 3, 7, 8, 9;
    variances << 1, 4, 9, 2, 5, 8, 3, 6, 7;
    const MatrixXd covariance = variances.asDiagonal(), extent = variances.head(3).asDiagonal();
    pelorus::TrackEntry entry;
    entry.id = 3;
    entry.mean = mean.data();
    entry.covariance = covariance.data();
    entry.extent = extent.data();
    builder.add(entry);
    rig.stage->receive(RigidRegistration::tracks_in, builder.message(second));
    const plr_tracks& told = rig.bench.published.back().tracks();
    CHECK(std::string(told.frame) == "eo");
    REQUIRE(told.space->size == 6);
    VectorXd expected(6), spread(6);
    expected << 40, -20, 5, 2, -1, 3;
    spread << 4, 1, 9, 5, 2, 8;
    CHECK((VectorXd(pelorus::item(told.mean, 0)) - expected).norm() < 1e-12);
    CHECK((MatrixXd(pelorus::item(told.covariance, 0)) - MatrixXd(spread.asDiagonal())).norm() < 1e-12);
    CHECK((MatrixXd(pelorus::item(told.extent, 0)) - MatrixXd(spread.head(3).asDiagonal())).norm() < 1e-12);
    CHECK(told.ids[0] == 3);
}

TEST_CASE("rigid registration: in the plane it turns, and refuses to tilt", "[registration]") {
    const pelorus::Space polar({{"range", "m"}, {"azimuth", "rad", 0, 0, true}});
    Rig rig("{attitude: [0 rad, 0 rad, 0.5 rad]}", "polar", "{}", "polar");
    VectorXd z(2);
    z << 100, 0.2;
    const VectorXd told = pelorus::item(rig.scan(polar, z, MatrixXd::Identity(2, 2)).measurements, 0);
    CHECK(told(0) == Approx(100));
    CHECK(told(1) == Approx(-0.3));
    CHECK_THROWS_WITH(Rig("{attitude: [0 rad, 0.1 rad, 0 rad]}", "polar", "{}", "polar"),
                      Catch::Contains("this motion tilts"));
}

TEST_CASE("rigid registration: parts that cannot be moved so are refused", "[registration]") {
    CHECK_THROWS_WITH(Rig("{}", "bearings", "{}"), Catch::Contains("determines a position"));
    CHECK_THROWS_WITH(Rig("{}", "spherical_rate", "{}"), Catch::Contains("determines a position"));
    CHECK_THROWS_WITH(Rig("{}", "spherical", "{}", "polar"), Catch::Contains("tells 3 coordinates"));
    CHECK_THROWS_WITH(Rig("{covariance: kept}", "spherical", "{}"), Catch::Contains("cannot be kept"));
    CHECK_THROWS_WITH(Rig("{direction: inverse}", "spherical", "{}"), Catch::Contains("which way a motion goes"));
}
