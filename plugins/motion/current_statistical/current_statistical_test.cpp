#include "../../../tests/support/waveform_trace.hpp"
#include "../../common/axis_models/constant_acceleration.hpp"
#include "../../common/axis_models/singer.hpp"

using namespace test_support;

TEST_CASE("the current statistical model follows the reference's noise-free run", "[motion]") {
    const Instance instance(
        "motion", "current_statistical",
        {{"dimension", "2"}, {"maximum_acceleration", "100 m/s2"}, {"minimum_acceleration", "-120 m/s2"}});
    check_waveform_trace(instance, "CS");
}

TEST_CASE("the current statistical model moves its mean at the acceleration and spreads points as Singer does",
          "[motion]") {
    const Instance instance("motion", "current_statistical", {{"dimension", "1"}, {"maneuver_rate", "0.3 1/s"}});
    const Eigen::Vector3d mean(10.0, -2.0, 4.0), offset(1.0, 0.5, -0.25);
    const MotionFilter filter(instance, mean, Eigen::Matrix3d::Identity());
    const Eigen::VectorXd after = filter.moved(1.5, mean);
    CHECK(relative_difference(after, constant_acceleration::transition(1.5) * mean) < 1e-15);
    const Eigen::Matrix3d f = singer::exact_transition(0.3, 1.5);
    CHECK(relative_difference(filter.moved(1.5, mean + offset) - after, f * offset) < 1e-13);
    CHECK(relative_difference(filter.jacobian(1.5), f) < 1e-15);
}

TEST_CASE("the current statistical variance is what is left to the bound on the acceleration's side", "[motion]") {
    const Instance instance(
        "motion", "current_statistical",
        {{"dimension", "2"}, {"maximum_acceleration", "100 m/s2"}, {"minimum_acceleration", "-120 m/s2"}});
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(6);
    mean(4) = 20.0;
    mean(5) = -30.0;
    const MotionFilter filter(instance, mean, Eigen::MatrixXd::Identity(6, 6));
    const Eigen::MatrixXd q = filter.noise(1.0, mean);
    const double ratio = 4.0 / std::acos(-1.0) - 1.0;
    // The acceleration of Singer's process of rate 0.6 1/s regains 1 - e^-1.2 of its variance in a second.
    CHECK(q(4, 4) == Approx(ratio * 80.0 * 80.0 * (1.0 - std::exp(-1.2))).epsilon(1e-13));
    CHECK(q(5, 5) == Approx(ratio * 90.0 * 90.0 * (1.0 - std::exp(-1.2))).epsilon(1e-13));
    CHECK(q(4, 5) == 0.0);
    CHECK(q == q.transpose());
}

TEST_CASE("a step of the current statistical model may be cut", "[motion]") {
    const Instance instance("motion", "current_statistical", {{"dimension", "1"}});
    const Eigen::Vector3d mean(10.0, -2.0, 4.0);
    const MotionFilter whole(instance, mean, Eigen::Matrix3d::Identity());
    MotionFilter cut(instance, mean, Eigen::Matrix3d::Identity()), once = whole;
    cut.predict(0.4);
    cut.predict(0.6);
    once.predict(1.0);
    CHECK(relative_difference(cut.mean(), once.mean()) < 1e-14);
    CHECK(relative_difference(cut.covariance(), once.covariance()) < 1e-13);
    CHECK((MotionUnderTest(instance).flags() & PLR_MOTION_LINEAR) == 0);
    CHECK((MotionUnderTest(instance).flags() & PLR_MOTION_CONSTANT_NOISE) == 0);
}
