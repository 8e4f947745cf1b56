#include "placement.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace {

using rigid::Matrix;
using rigid::Motion;
using rigid::Placement;
using rigid::Vector;

const double degree = std::acos(-1.0) / 180;

Vector<4> product(const Vector<4>& a, const Vector<4>& b) {
    return {
        a(0) * b(0) - a(1) * b(1) - a(2) * b(2) - a(3) * b(3), a(0) * b(1) + a(1) * b(0) + a(2) * b(3) - a(3) * b(2),
        a(0) * b(2) - a(1) * b(3) + a(2) * b(0) + a(3) * b(1), a(0) * b(3) + a(1) * b(2) - a(2) * b(1) + a(3) * b(0)};
}
Vector<4> about(int axis, double angle) {
    Vector<4> q(std::cos(angle / 2), 0, 0, 0);
    q(1 + axis) = std::sin(angle / 2);
    return q;
}

}  // namespace

TEST_CASE("rigid registration: a quaternion and the product of three rotations turn alike", "[registration]") {
    for (int k = 0; k < 50; ++k) {
        const double roll = -3 + 0.11 * k, pitch = 1.5 - 0.05 * k, yaw = 0.3 * k - 7;
        const Matrix<3> matrix = rigid::rotation_of_attitude({roll, pitch, yaw});
        const Matrix<3> turned =
            rigid::rotation_of_quaternion(product(about(2, yaw), product(about(1, pitch), about(0, roll))));
        CHECK((matrix - turned).cwiseAbs().maxCoeff() < 1e-12);
        CHECK((turned * turned.transpose() - Matrix<3>::Identity()).cwiseAbs().maxCoeff() < 1e-12);
    }
}

TEST_CASE("rigid registration: the radar's axes go into those of the electro-optical head as published",
          "[registration]") {
    // The matrix of the scenario: the active rotation by qx(1 deg) qy(-2 deg) qz(3 deg), z applied first.
    Matrix<3> published;
    published << .998021, -.052304, -.034899, .051720, .998509, -.017442, .035760, .015602, .999239;
    Placement by_attitude, by_quaternion;
    by_attitude.attitude = {-1 * degree, 2 * degree, -3 * degree};
    by_attitude.translation = by_quaternion.translation = {10, 5, 3};
    const Vector<4> q = product(about(0, degree), product(about(1, -2 * degree), about(2, 3 * degree)));
    by_quaternion.quaternion = {q(0), -q(1), -q(2), -q(3)};  // the attitude is the way back
    const Motion one = by_attitude.into(), other = by_quaternion.into();
    CHECK((one.rotation - published).cwiseAbs().maxCoeff() < 6e-7);
    CHECK((one.rotation - other.rotation).cwiseAbs().maxCoeff() < 1e-12);
    CHECK((one.translation - other.translation).norm() < 1e-12);
    CHECK(one({10, 5, 3}).norm() < 1e-12);
    const Vector<3> point(500, -300, 900);
    CHECK((one(point) - published * (point - Vector<3>(10, 5, 3))).norm() < 1e-3);
    CHECK((one.inverse()(one(point)) - point).norm() < 1e-10);
}

TEST_CASE("rigid registration: sites a quarter of the equator apart", "[registration]") {
    Placement placement;
    placement.from_site = {0, 0, 0};
    placement.to_site = {0, 90 * degree, 100};
    const double radius = 6378137;  // WGS84, at the equator
    const Motion motion = placement.into();
    // East there is down here, up there is east here, north is north.
    CHECK((motion({0, 0, 0}) - Vector<3>(-radius, 0, -radius - 100)).norm() < 1e-6);
    CHECK((motion({radius, 7, 0}) - Vector<3>(-radius, 7, -100)).norm() < 1e-6);
    CHECK((motion({radius + 103, 0, -radius - 5}) - Vector<3>(5, 0, 3)).norm() < 1e-6);
    placement.translation = {5, 6, 7};
    placement.attitude = {0, 0, 90 * degree};
    const Motion turned = placement.into();
    const Vector<3> point(1e5, 2e5, -3e4), there = motion(point) - Vector<3>(5, 6, 7);
    CHECK((turned(point) - Vector<3>(there(1), -there(0), there(2))).norm() < 1e-6);
}

TEST_CASE("rigid registration: placements that say too much or too little are refused", "[registration]") {
    Placement placement;
    CHECK_FALSE(placement.is_given());
    placement.attitude = {0, 0, 0};
    placement.quaternion = {1, 0, 0, 0};
    CHECK_THROWS_WITH(placement.into(), Catch::Contains("together with `attitude`"));
    placement.attitude.reset();
    placement.quaternion = {1, 0, 0, 0.1};
    CHECK_THROWS_WITH(placement.into(), Catch::Contains("a rotation 1"));
    placement.quaternion.reset();
    placement.from_site = {43, 5, 0};
    CHECK_THROWS_WITH(placement.into(), Catch::Contains("is required"));
    placement.to_site = {0.7, 0.1, 0};
    CHECK_THROWS_WITH(placement.into(), Catch::Contains("beyond 90 deg"));
    CHECK(Motion().keeps_the_plane());
    CHECK_FALSE(Motion{rigid::rotation_of_attitude({0.1, 0, 0}), {}}.keeps_the_plane());
    CHECK_FALSE(Motion{rigid::rotation_of_attitude({180 * degree, 0, 0}), {}}.keeps_the_plane());
}
