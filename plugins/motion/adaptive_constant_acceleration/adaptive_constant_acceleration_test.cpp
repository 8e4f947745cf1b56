#include "../../../tests/support/waveform_trace.hpp"

using namespace test_support;

TEST_CASE("adaptive constant acceleration follows the reference's noise-free run", "[motion]") {
    const Instance piecewise("motion", "adaptive_constant_acceleration", {{"dimension", "2"}});
    check_waveform_trace(piecewise, "ACA");
    const Instance white("motion", "adaptive_constant_acceleration",
                         {{"dimension", "2"}, {"noise_form", "white_jerk"}});
    check_waveform_trace(white, "ACA_cont");
}

namespace {

/// A posterior whose velocity has changed its variance since the last.
MotionFilter line(const Instance& instance) {
    Eigen::Matrix3d covariance;
    covariance << 100.0, 3.0, 1.0, 3.0, 9.0, 2.0, 1.0, 2.0, 4.0;
    return {instance, Eigen::Vector3d(5.0, 1.0, 0.5), covariance};
}

}  // namespace

TEST_CASE("the adaptive variance is that of twice the change of the acceleration", "[motion]") {
    const Instance instance("motion", "adaptive_constant_acceleration", {{"dimension", "1"}});
    const MotionFilter filter = line(instance);
    // s^2 = (4 - pi)/pi (4 x 4 - 4 x 2/T + (9 + 9)/T^2) with T = 2 s: 16.5; Q = T^2 s^2 g g'.
    const double s2 = (4.0 - std::acos(-1.0)) / std::acos(-1.0) * 16.5;
    const Eigen::Vector3d g(2.0, 2.0, 1.0);
    const Eigen::MatrixXd expected = 4.0 * s2 * g * g.transpose();
    CHECK(relative_difference(filter.noise(2.0, filter.mean()), expected) < 1e-14);
    const Eigen::MatrixXd factor = filter.noise_factor(2.0, filter.mean());
    REQUIRE(factor.cols() == 1);
    CHECK(relative_difference(factor * factor.transpose(), expected) < 1e-14);
}

TEST_CASE("the adaptive variance remembers the velocity of the posterior before", "[motion]") {
    const Instance instance("motion", "adaptive_constant_acceleration", {{"dimension", "1"}});
    MotionFilter filter = line(instance);
    CHECK(filter.record()(0) == 9.0);  // the start stands for what was before it
    filter.predict(1.0);
    CHECK(filter.record()(0) == 9.0);
    const double velocity_variance = filter.covariance()(1, 1);
    filter.predict(1.0);
    CHECK(filter.record()(0) == velocity_variance);
}

TEST_CASE("a covariance that rounding has made indefinite gives no negative noise", "[motion]") {
    const Instance instance("motion", "adaptive_constant_acceleration", {{"dimension", "1"}});
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
    covariance(1, 2) = covariance(2, 1) = 3.0;  // 4 - 12 + 1 + 1
    const MotionFilter filter(instance, Eigen::Vector3d::Zero(), covariance);
    CHECK(filter.noise(1.0, filter.mean()).isZero(0.0));
    CHECK(filter.noise_factor(1.0, filter.mean()).isZero(0.0));
}

TEST_CASE("white jerk spreads the adaptive variance over the step", "[motion]") {
    const Instance instance("motion", "adaptive_constant_acceleration",
                            {{"dimension", "1"}, {"noise_form", "white_jerk"}});
    const MotionFilter filter = line(instance);
    const double weight = 4.0 * (4.0 - std::acos(-1.0)) / std::acos(-1.0) * 16.5;
    Eigen::Matrix3d q;
    q << 32.0 / 20.0, 16.0 / 8.0, 8.0 / 6.0, 16.0 / 8.0, 8.0 / 3.0, 2.0, 8.0 / 6.0, 2.0, 2.0;
    CHECK(relative_difference(filter.noise(2.0, filter.mean()), weight * q) < 1e-14);
    CHECK(MotionUnderTest(instance).part().extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR) == nullptr);
}

TEST_CASE("adaptive constant acceleration says that its noise is not constant", "[motion]") {
    const Instance instance("motion", "adaptive_constant_acceleration");
    const MotionUnderTest motion(instance);
    CHECK((motion.flags() & PLR_MOTION_LINEAR) != 0);
    CHECK((motion.flags() & (PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD)) == 0u);
    CHECK(motion.structure() == nullptr);
    CHECK(motion.size() == 9);
}
