#include "../../../tests/support/motion_checks.hpp"

#include "../../common/axis_models/singer.hpp"

#include <Eigen/Geometry>

using namespace test_support;

namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Process noise of a step of `dt` s while a plane with this normal is told to hold.
MatrixXd noise(const Instance& instance, double dt, const Vector3d& normal, double holds) {
    const pelorus::MotionPart part = instance.as<pelorus::MotionPart>();
    const std::vector<double> inputs{normal(0), normal(1), normal(2), holds};
    Call call;
    plr_call context = call;
    context.inputs = inputs.data();
    const Eigen::VectorXd state = Eigen::VectorXd::Zero(9);
    const MatrixXd covariance = MatrixXd::Identity(9, 9);
    MatrixXd out(9, 9);
    auto args = pelorus::arguments<plr_motion_noise>();
    args.dt = pelorus::const_view(&dt, 1, 1, 1);
    args.state = args.predicted = pelorus::const_view(state);
    args.covariance = pelorus::const_view(covariance);
    args.out = pelorus::view(out);
    if (part.table().noise(part.self(), &context, &args) != PLR_OK) throw std::runtime_error(call.message());
    return out;
}

/// The noise of one direction: of position, velocity and acceleration along it.
Matrix3d along(const MatrixXd& q, const Vector3d& direction) {
    Matrix3d out;
    for (int row = 0; row < 3; ++row)
        for (int col = 0; col < 3; ++col) out(row, col) = direction.dot(q.block<3, 3>(3 * row, 3 * col) * direction);
    return out;
}

const Values parameters{{"maneuver_rate", "0.3 1/s"}, {"acceleration", "50 m/s2"}, {"acceleration_across", "4 m/s2"}};

}  // namespace

TEST_CASE("planar motion is Singer's while no plane is told, and once it is rejected", "[motion]") {
    const Instance planar("motion", "planar", parameters);
    const Instance singer("motion", "singer", {{"maneuver_rate", "0.3 1/s"}, {"acceleration", "50 m/s2"}});
    const MotionUnderTest known(singer);
    for (const double dt : {0.5, 3.0, -1.0}) {
        CHECK(relative_difference(MotionUnderTest(planar).jacobian(dt), known.jacobian(dt)) < 1e-14);
        CHECK(relative_difference(noise(planar, dt, Vector3d(1, 2, 3), 0), known.noise(dt)) < 1e-14);
        CHECK(relative_difference(noise(planar, dt, Vector3d::Zero(), 1), known.noise(dt)) < 1e-14);
    }
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(9, -4, 7);
    CHECK(relative_difference(MotionUnderTest(planar).propagate(2, x), known.propagate(2, x)) < 1e-14);
}

TEST_CASE("planar motion: while the plane holds, noise across it is small and in it as before", "[motion]") {
    const Instance planar("motion", "planar", parameters);
    const Vector3d n = Vector3d(1, -2, 2) / 3, u = n.unitOrthogonal();
    const MatrixXd q = noise(planar, 0.5, 7 * n, 1);
    const Matrix3d unit = singer::exact_noise(0.3, 0.5);
    CHECK(relative_difference(along(q, n), 16 * unit) < 1e-12);
    CHECK(relative_difference(along(q, u), 2500 * unit) < 1e-12);
    CHECK(relative_difference(along(q, n.cross(u)), 2500 * unit) < 1e-12);
    CHECK(std::fabs(u.dot(q.topLeftCorner<3, 3>() * n)) < 1e-12 * q(0, 0));
    // Half of it half way between, and what is beyond 1 is 1.
    CHECK(relative_difference(along(noise(planar, 0.5, n, 0.5), n), 1258 * unit) < 1e-12);
    CHECK(relative_difference(noise(planar, 0.5, n, 9), q) < 1e-12);
}

TEST_CASE("planar motion: accelerations across a plane are not the larger ones", "[motion]") {
    CHECK_THROWS_WITH(Instance("motion", "planar", {{"acceleration", "1 m/s2"}, {"acceleration_across", "2 m/s2"}}),
                      Catch::Contains("is above acceleration"));
}
