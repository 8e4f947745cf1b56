#include "../../../tests/support/motion_at.hpp"
#include "../../../tests/support/motion_filter.hpp"

#include <unsupported/Eigen/MatrixFunctions>

using namespace test_support;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

/// Axes and site of the group of space objects.
Values over_site(Values more) {
    more["axes"] = "enu";
    more["origin"] = "[37.5 deg, 0, 0]";
    return more;
}

VectorXd state(const Vector3d& position, const Vector3d& velocity, const Vector3d& acceleration) {
    VectorXd x(9);
    x << position, velocity, acceleration;
    return x;
}

const Vector3d start(0.0, 0.0, 1e5), speed(3000.0, 3000.0, 3000.0);
const Vector3d force(-0.08076393, -0.26711628, -9.15091277);  // m/s2 there, from an independent implementation

/// F and Q of Singer's process on one axis, by Van Loan's method: the exponential of a matrix that knows neither of them.
/// C. F. Van Loan, Computing integrals involving the matrix exponential, IEEE Transactions on Automatic Control 23(3), 1978.
std::pair<Matrix3d, Matrix3d> by_van_loan(double rate, double deviation, double dt) {
    Matrix3d a = Matrix3d::Zero(), density = Matrix3d::Zero();
    a(0, 1) = a(1, 2) = 1.0;
    a(2, 2) = -rate;
    density(2, 2) = 2.0 * rate * deviation * deviation;
    MatrixXd both = MatrixXd::Zero(6, 6);
    both << -a, density, Matrix3d::Zero(), a.transpose();
    const MatrixXd exponential = (both * dt).exp();
    const Matrix3d f = exponential.bottomRightCorner<3, 3>().transpose();
    return {f, f * exponential.topRightCorner<3, 3>()};
}

MatrixXd kronecker(const Matrix3d& block, const Matrix3d& other) {
    MatrixXd out(9, 9);
    for (int row = 0; row < 3; ++row)
        for (int col = 0; col < 3; ++col) out.block<3, 3>(3 * row, 3 * col) = block(row, col) * other;
    return out;
}

/// Q of a step from a state of zeros, with the extent of what moves.
MatrixXd noise_over(const Instance& instance, double dt, const Matrix3d& extent) {
    const auto part = instance.as<pelorus::MotionPart>();
    const VectorXd at = VectorXd::Zero(9);
    const MatrixXd covariance = MatrixXd::Zero(9, 9);
    MatrixXd out(9, 9);
    auto args = pelorus::arguments<plr_motion_noise>();
    args.dt = pelorus::const_view(&dt, 1, 1, 1);
    args.state = args.predicted = pelorus::const_view(at);
    args.covariance = pelorus::const_view(covariance);
    args.extent = pelorus::const_view(extent.data(), 3, 3, 1);
    args.out = pelorus::view(out);
    Call call;
    if (part.call(&plr_motion::noise, call, args) != PLR_OK) throw std::runtime_error(call.message());
    return out;
}

}  // namespace

TEST_CASE("a held step takes Singer's F and the force at the last estimate", "[motion][ballistic]") {
    const Instance group("motion", "ballistic",
                         over_site({{"maneuver_rate", "0.016666666666666666"}, {"integration", "held"}}));
    const auto [f, q] = by_van_loan(1.0 / 60.0, 1.0, 1.0);
    const VectorXd x = state(start, speed, {0.5, -0.25, 1.0});
    VectorXd expected = kronecker(f, Matrix3d::Identity()) * x;
    expected.head<3>() += force / 2.0;
    expected.segment<3>(3) += force;
    const MotionAt motion(group);
    CHECK((motion.propagate(1.0, x) - expected).norm() < 3e-8);
    CHECK(relative_difference(motion.jacobian(1.0, x), kronecker(f, Matrix3d::Identity())) < 1e-13);
    CHECK(relative_difference(motion.noise(1.0, x), kronecker(q, Matrix3d::Identity())) < 1e-12);

    // Points about the estimate feel the force that is felt there.
    const MotionFilter filter(group, x, MatrixXd::Identity(9, 9));
    VectorXd away = VectorXd::Zero(9);
    away << 1e5, -2e5, 3e5, 100.0, 200.0, -300.0, 1.0, 2.0, 3.0;
    const VectorXd moved = filter.moved(1.0, x + away) - filter.moved(1.0, x);
    CHECK((moved - kronecker(f, Matrix3d::Identity()) * away).norm() < 1e-8);
}

TEST_CASE("a held step without manoeuvres is straight flight and the force", "[motion][ballistic]") {
    const Instance target("motion", "ballistic", over_site({{"integration", "held"}, {"acceleration", "0.02"}}));
    const MotionAt motion(target);
    VectorXd x(6), expected(6);
    x << start, speed;
    expected << start + 2.0 * speed + 2.0 * force, speed + 2.0 * force;
    CHECK((motion.propagate(2.0, x) - expected).norm() < 1e-7);
    MatrixXd f = MatrixXd::Identity(6, 6);
    f.topRightCorner<3, 3>() = 2.0 * Matrix3d::Identity();
    CHECK(motion.jacobian(2.0, x) == f);
    Eigen::Matrix2d q;
    q << 1.0, 1.0, 1.0, 1.0;  // h h' T^2 0.02^2 with h = [1; 1], T = 2 s
    for (int axis = 0; axis < 3; ++axis)
        CHECK(relative_difference(motion.noise(2.0, x)(Eigen::seqN(axis, 2, 3), Eigen::seqN(axis, 2, 3)),
                                  0.0004 * 4.0 * q) < 1e-14);
    CHECK_THROWS_WITH(motion.propagate(-1.0, x), Catch::Contains("backward"));
}

TEST_CASE("drag is held like every other force", "[motion][ballistic]") {
    const Instance flight(
        "motion", "ballistic",
        {{"gravity", "none"}, {"drag", "known"}, {"drag_parameter", "2e-3"}, {"integration", "held"}});
    VectorXd x = VectorXd::Zero(6);
    x(3) = 300.0;
    CHECK(MotionAt(flight).propagate(0.5, x)(3) == Approx(300.0 - 0.5 * 1.225 / 2.0 * 2e-3 * 300.0 * 300.0));
}

TEST_CASE("without forces a manoeuvring flight is Singer's", "[motion][ballistic]") {
    const Instance flight("motion", "ballistic",
                          {{"gravity", "none"}, {"maneuver_rate", "0.25"}, {"acceleration", "3"}});
    const MotionAt motion(flight);
    const VectorXd x = state({1.0, 2.0, 3.0}, {-40.0, 50.0, 60.0}, {4.0, -5.0, 6.0});
    for (const double dt : {0.3, 2.0, 20.0, -2.0}) {
        const auto [f, q] = by_van_loan(0.25, 3.0, dt);
        CHECK((motion.propagate(dt, x) - kronecker(f, Matrix3d::Identity()) * x).norm() < 1e-5);
        CHECK(relative_difference(motion.jacobian(dt, x), kronecker(f, Matrix3d::Identity())) < 1e-6);
        if (dt > 0.0) CHECK(relative_difference(motion.noise(dt, x), kronecker(q, Matrix3d::Identity())) < 1e-10);
    }
}

TEST_CASE(
    "a flight that does not manoeuvre goes where an independent integration goes, with its acceleration or without",
    "[motion][ballistic]") {
    const Instance flight("motion", "ballistic", over_site({{"maneuver_rate", "0.1"}}));
    const VectorXd end = MotionAt(flight).propagate(760.0, state(start, speed, Vector3d::Zero()));
    CHECK((end.head<3>() - Vector3d(2082313.748, 1972529.612, 121524.833)).norm() < 2e-3);
    CHECK(end.tail<3>() == Vector3d::Zero());
}

TEST_CASE("the Jacobian of a manoeuvring flight is its derivative", "[motion][ballistic]") {
    const VectorXd x = state({-4e3, 9e3, 11e3}, {500.0, -800.0, 300.0}, {2.0, 3.0, -4.0});
    const Values drag{
        {"maneuver_rate", "0.02"}, {"drag", "known"}, {"drag_parameter", "1e-3"}, {"maximum_step", "0.2"}};
    for (const Values& with : {over_site({{"maneuver_rate", "0.05"}}), drag, over_site(drag)})
        for (const double dt : {0.01, 1.0, 5.3, -2.0}) {
            const Instance flight("motion", "ballistic", with);
            CHECK(MotionAt(flight).jacobian_error(dt, x) < 1e-7);
        }
}

TEST_CASE("manoeuvres over an extent are as large as the extent on each of its axes", "[motion][ballistic]") {
    Matrix3d extent;
    extent << 400.0, 30.0, -20.0, 30.0, 900.0, 10.0, -20.0, 10.0, 100.0;  // m2
    for (const char* const integration : {"held", "runge_kutta"}) {
        const Instance group("motion", "ballistic",
                             over_site({{"maneuver_rate", "0.016666666666666666"},
                                        {"noise_over_extent", "1e-3"},
                                        {"integration", integration}}));
        CHECK((MotionUnderTest(group).flags() & PLR_MOTION_USES_EXTENT) != 0);
        for (const double dt : {1.0, 7.0}) {
            const MatrixXd q = noise_over(group, dt, extent);
            CHECK(relative_difference(q, kronecker(by_van_loan(1.0 / 60.0, 1e-3, dt).second, extent)) < 1e-11);
            CHECK(q == q.transpose());
        }
    }
    // The reference library: alpha = 0.1 1/s, 2 alpha sigma^2 = 0.01, dt = 0.5 s.
    const Instance known("motion", "ballistic",
                         {{"maneuver_rate", "0.1"}, {"noise_over_extent", "1"}, {"integration", "held"}});
    const MatrixXd answer = matrix(reference("models_and_filters.json").at("Singer q=0.01 alpha=0.1 dt=0.5").at("Q"));
    const Matrix3d variance = 0.01 / (2.0 * 0.1) * Matrix3d::Identity();
    CHECK(relative_difference(noise_over(known, 0.5, variance), kronecker(answer, Matrix3d::Identity())) < 1e-9);
}

TEST_CASE("a manoeuvring flight refuses what its choices leave without a meaning", "[motion][ballistic]") {
    const std::vector<std::pair<std::string, Values>> wrong{
        {"noise", {{"maneuver_rate", "0.1"}, {"noise", "1"}}},
        {"noise_over_extent", {{"noise_over_extent", "1"}}},
        {"noise_over_extent", {{"maneuver_rate", "0.1"}, {"noise_over_extent", "1"}, {"acceleration", "1"}}},
        {"prior_acceleration", {{"prior_acceleration", "1"}}},
        {"prior_acceleration", {{"maneuver_rate", "0.1"}, {"acceleration", "0"}}},
        {"maneuver_rate", {{"maneuver_rate", "0.1"}, {"drag", "estimated"}}},
        {"integration", {{"integration", "held"}, {"drag", "estimated"}}},
        {"maximum_step", {{"integration", "held"}, {"maximum_step", "1"}}}};
    for (const auto& [parameter, with] : wrong) {
        try {
            const Instance flight("motion", "ballistic", with);
            FAIL(parameter << " must be refused");
        } catch (const Refused& refused) {
            CHECK(refused.where == parameter);
        }
    }
    const Instance prior("motion", "ballistic",
                         {{"maneuver_rate", "0.1"}, {"noise_over_extent", "1"}, {"prior_acceleration", "0.1"}});
    CHECK(MotionUnderTest(prior).component(8).prior_deviation == 0.1);
}
