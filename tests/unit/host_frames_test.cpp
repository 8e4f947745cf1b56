#include <catch2/catch.hpp>
#include <cmath>
#include <Eigen/Dense>
#include <GeographicLib/LocalCartesian.hpp>
#include <limits>
#include <random>

#include "host/plugin_error.hpp"
#include "host/services.hpp"

using namespace pelorus::host;
using Catch::Matchers::Contains;
using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double degree = M_PI / 180;

Matrix3d turned(double yaw, double pitch, double roll) {
    return (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
            Eigen::AngleAxisd(roll, Vector3d::UnitX()))
        .toRotationMatrix();
}

void add_local(FrameTree& tree, const std::string& name, const std::string& parent, const Matrix3d& rotation,
               const Vector3d& at) {
    tree.add_local(name, parent, rotation.data(), at.data());
}

struct Transform {
    Matrix3d rotation;
    Vector3d translation;
    Vector3d operator()(const Vector3d& p) const { return rotation * p + translation; }
};

Transform transform(const FrameTree& tree, const char* from, const char* to) {
    Transform result;
    plr_error error = empty_error();
    const plr_frames& frames = tree.service();
    INFO(error.message);
    plr_frame_pose pose{};
    pose.struct_size = sizeof pose;
    REQUIRE(frames.transform(frames.context, from, to, 0, &pose, &error) == PLR_OK);
    result.rotation = Matrix3d::Map(pose.rotation);
    result.translation = Vector3d::Map(pose.translation);
    return result;
}

Vector3d from_geodetic(const FrameTree& tree, const char* frame, const Vector3d& geodetic) {
    Vector3d result;
    plr_error error = empty_error();
    const plr_frames& frames = tree.service();
    REQUIRE(frames.from_geodetic(frames.context, frame, geodetic.data(), result.data(), &error) == PLR_OK);
    return result;
}

Vector3d to_geodetic(const FrameTree& tree, const char* frame, const Vector3d& cartesian) {
    Vector3d result;
    plr_error error = empty_error();
    const plr_frames& frames = tree.service();
    REQUIRE(frames.to_geodetic(frames.context, frame, cartesian.data(), result.data(), &error) == PLR_OK);
    return result;
}

std::string transform_error(const FrameTree& tree, const char* from, const char* to) {
    plr_frame_pose pose{};
    pose.struct_size = sizeof pose;
    plr_error error = empty_error();
    const plr_frames& frames = tree.service();
    REQUIRE(frames.transform(frames.context, from, to, 0, &pose, &error) == PLR_E_DATA);
    CHECK(error.code == PLR_E_DATA);
    return error.message;
}

double distance(const Vector3d& a, const Vector3d& b) { return (a - b).norm(); }

}  // namespace

TEST_CASE("A local frame stands to its parent at C p + t", "[host]") {
    FrameTree tree;
    const Matrix3d c = turned(0.3, -0.2, 0.1);
    add_local(tree, "radar", "", c, {10, 20, 30});
    const Transform out = transform(tree, "radar", "");
    CHECK(out.rotation == c);  // exactly: a parent takes the config's numbers as they are
    CHECK(out.translation == Vector3d(10, 20, 30));
    const Vector3d p(1, 2, 3);
    CHECK(distance(transform(tree, "", "radar")(out(p)), p) < 1e-13);
    // By hand: a quarter turn about z moves x to y.
    add_local(tree, "quarter", "", turned(M_PI / 2, 0, 0), {100, 0, 0});
    CHECK(distance(transform(tree, "quarter", "")({1, 0, 0}), {100, 1, 0}) < 1e-13);
}

TEST_CASE("Frames chain through their parents, in any direction", "[host]") {
    FrameTree tree;
    const Matrix3d c1 = turned(1, 0.2, 0.3), c2 = turned(-2, 0.5, 0.1), c3 = turned(0.4, -1, 2);
    const Vector3d t1(1, 2, 3), t2(-4, 5, 6), t3(7, 8, -9);
    add_local(tree, "ship", "", c1, t1);
    add_local(tree, "mast", "ship", c2, t2);
    add_local(tree, "buoy", "", c3, t3);
    const Vector3d p(0.5, -0.25, 4);
    const Vector3d in_root = c1 * (c2 * p + t2) + t1;
    CHECK(distance(transform(tree, "mast", "")(p), in_root) < 1e-13);
    CHECK(distance(transform(tree, "mast", "buoy")(p), c3.transpose() * (in_root - t3)) < 1e-13);
    const Transform there = transform(tree, "mast", "buoy"), back = transform(tree, "buoy", "mast");
    CHECK(distance(back(there(p)), p) < 1e-13);
    const Transform same = transform(tree, "mast", "mast");
    CHECK(same.rotation == Matrix3d::Identity());
    CHECK(same.translation == Vector3d::Zero());
}

TEST_CASE("A geodetic frame agrees with GeographicLib's local Cartesian", "[host]") {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int trial = 0; trial < 200; ++trial) {
        const double latitude = 89 * unit(random), longitude = 180 * unit(random), height = 5000 * unit(random);
        FrameTree tree;
        tree.add_geodetic("site", latitude * degree, longitude * degree, height);
        const GeographicLib::LocalCartesian local(latitude, longitude, height);
        const double other_latitude = latitude + unit(random) * 0.5, other_longitude = longitude + unit(random);
        const double other_height = 1e4 * unit(random);
        Vector3d expected;
        local.Forward(other_latitude, other_longitude, other_height, expected.x(), expected.y(), expected.z());
        const Vector3d geodetic(other_latitude * degree, other_longitude * degree, other_height);
        const Vector3d found = from_geodetic(tree, "site", geodetic);
        REQUIRE(distance(found, expected) < 1e-8);
        // 1e-14 rad are 64 nm on the ground.
        const Vector3d back = to_geodetic(tree, "site", found);
        REQUIRE(std::abs(back[0] - geodetic[0]) < 1e-14);
        REQUIRE(std::abs(std::remainder(back[1] - geodetic[1], 2 * M_PI)) * std::cos(geodetic[0]) < 1e-14);
        REQUIRE(std::abs(back[2] - geodetic[2]) < 1e-8);
    }
}

TEST_CASE("Known places of the Earth come out where they are", "[host]") {
    FrameTree tree;
    // At latitude 0, longitude 0 east, north, up are the Earth's y, z, x, and the origin is the semi-major axis of WGS84 away.
    tree.add_geodetic("gulf", 0, 0, 0);
    CHECK(distance(from_geodetic(tree, "gulf", {M_PI / 2, 0, 0}), {0, 6356752.314245179, -6378137.0}) < 2e-9);
    CHECK(distance(from_geodetic(tree, "gulf", {0, M_PI / 2, 0}), {6378137.0, 0, -6378137.0}) < 2e-9);
    CHECK(distance(from_geodetic(tree, "gulf", {0, 0, 1234}), {0, 0, 1234}) < 2e-9);
    // The worked example of GeographicLib's CartConvert: 33.3 44.4 6000 -> 3816209.60 3737108.55 3485109.57.
    const Vector3d local = from_geodetic(tree, "gulf", {33.3 * degree, 44.4 * degree, 6000});
    CHECK(distance(local, {3737108.55, 3485109.57, 3816209.60 - 6378137.0}) < 0.01);
}

TEST_CASE("Two geodetic frames and what hangs below them are joined through the Earth", "[host]") {
    FrameTree tree;
    tree.add_geodetic("north", 60 * degree, 20 * degree, 50);
    tree.add_geodetic("south", 59.5 * degree, 21 * degree, 10);
    add_local(tree, "radar", "north", turned(0.7, 0.01, -0.02), {3, -2, 15});
    add_local(tree, "mount", "radar", turned(0.1, 0, 0), {0.25, 0, 0});
    const Vector3d geodetic(59.7 * degree, 20.4 * degree, 900);
    const Vector3d in_south = from_geodetic(tree, "south", geodetic);
    CHECK(distance(transform(tree, "mount", "south")(from_geodetic(tree, "mount", geodetic)), in_south) < 1e-8);
    CHECK(distance(transform(tree, "south", "mount")(in_south), from_geodetic(tree, "mount", geodetic)) < 1e-8);
    const Vector3d back = to_geodetic(tree, "mount", from_geodetic(tree, "mount", geodetic));
    CHECK(distance(back, geodetic) < 1e-8);
    // Below one origin the Earth's radius does not blur anything.
    CHECK(distance(transform(tree, "mount", "radar").translation, {0.25, 0, 0}) < 1e-15);
}

TEST_CASE("Frames that are not there or not joined are told by name", "[host]") {
    FrameTree tree;
    CHECK(transform_error(tree, "nowhere", "") == "no frame nowhere in this graph; it has the root frame only");
    add_local(tree, "radar", "", Matrix3d::Identity(), {1, 2, 3});
    tree.add_geodetic("site", 1, 1, 0);
    CHECK(transform_error(tree, "radar", "nowhere") == "no frame nowhere in this graph; it has radar, site");
    CHECK(transform_error(tree, nullptr, "") == "frames: the name of a frame is NULL");
    CHECK(transform_error(tree, "", nullptr) == "frames: the name of a frame is NULL");
    CHECK(transform_error(tree, "radar", "site") ==
          "frame radar and frame site are not joined: one stands on Earth, the other below the root frame");
    const plr_frames& frames = tree.service();
    double position[3] = {0, 0, 0}, out[3];
    plr_frame_pose pose{};
    CHECK(frames.transform(frames.context, "radar", "", 0, nullptr, nullptr) == PLR_E_DATA);
    CHECK(frames.transform(frames.context, "radar", "", 0, &pose, nullptr) == PLR_E_DATA);  // tells no size
    pose.struct_size = sizeof pose;
    CHECK(frames.transform(frames.context, "radar", "nowhere", 0, &pose, nullptr) == PLR_E_DATA);
    plr_error error = empty_error();
    CHECK(frames.from_geodetic(frames.context, "radar", position, out, &error) == PLR_E_DATA);
    CHECK_THAT(error.message, Contains("frame radar has no geodetic origin"));
    error = empty_error();
    CHECK(frames.to_geodetic(frames.context, "", position, out, &error) == PLR_E_DATA);
    CHECK_THAT(error.message, Contains("the root frame has no geodetic origin"));
    error = empty_error();
    CHECK(frames.from_geodetic(frames.context, "site", nullptr, out, &error) == PLR_E_DATA);
}

TEST_CASE("Positions that are no places are refused", "[host]") {
    FrameTree tree;
    tree.add_geodetic("site", 1, 1, 0);
    const plr_frames& frames = tree.service();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    double out[3];
    for (const Vector3d& bad : {Vector3d(51.5, 0, 0), Vector3d(nan, 0, 0), Vector3d(0, nan, 0), Vector3d(0, 0, nan)}) {
        plr_error error = empty_error();
        CHECK(frames.from_geodetic(frames.context, "site", bad.data(), out, &error) == PLR_E_DATA);
        CHECK_THAT(error.message, Contains("not a geodetic position: expected latitude within +-pi/2 rad"));
    }
    plr_error error = empty_error();
    const double far_away[3] = {nan, 0, 0};
    CHECK(frames.to_geodetic(frames.context, "site", far_away, out, &error) == PLR_E_DATA);
}

TEST_CASE("A frame that cannot be is not added", "[host]") {
    FrameTree tree;
    const Matrix3d identity = Matrix3d::Identity();
    const Vector3d zero = Vector3d::Zero();
    add_local(tree, "radar", "", identity, zero);
    CHECK_THROWS_WITH(add_local(tree, "radar", "", identity, zero), "frame radar is there already");
    CHECK_THROWS_WITH(tree.add_geodetic("radar", 0, 0, 0), "frame radar is there already");
    CHECK_THROWS_WITH(add_local(tree, "", "", identity, zero), Contains("must have a name"));
    CHECK_THROWS_WITH(add_local(tree, "mount", "raddar", identity, zero), "frame mount has the unknown parent raddar");
    CHECK_THROWS_WITH(add_local(tree, "mirror", "", -identity, zero), Contains("no rotation"));
    CHECK_THROWS_WITH(add_local(tree, "scale", "", 1.01 * identity, zero), Contains("no rotation"));
    CHECK_THROWS_WITH(add_local(tree, "far", "", identity, {std::nan(""), 0, 0}), Contains("not finite"));
    CHECK_THROWS_WITH(tree.add_geodetic("degrees", 51.5, 0, 0), Contains("not on Earth"));
    CHECK_FALSE(tree.contains("mirror"));
    CHECK(tree.contains("radar"));
    CHECK(tree.contains(""));
}
