#include "../../common/axis_models/singer.hpp"
#include "../../../tests/support/motion_checks.hpp"
#include "../../../tests/support/reference.hpp"
#include "../../common/axis_models/constant_acceleration.hpp"

using namespace test_support;

namespace {

/// Q for alpha = 1, sigma = 1 by integrating 2 F(t) e e' F(t)' over 0..T (composite Gauss-Legendre of order 5): an answer that
/// neither the printed formula nor the series can share an error with.
Eigen::Matrix3d integrated_noise(double span) {
    const double nodes[] = {0.0, 0.53846931010568309, 0.90617984593866399};
    const double weights[] = {0.56888888888888889, 0.47862867049936647, 0.23692688505618909};
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    const int pieces = 64;
    const double half = span / pieces / 2.0;
    for (int piece = 0; piece < pieces; ++piece) {
        for (int k = -2; k <= 2; ++k) {
            const double node = (k < 0 ? -1.0 : 1.0) * nodes[std::abs(k)];
            const double t = half * (2 * piece + 1 + node);
            // (t - 1 + e^-t) by its series: the printed form is what is under test elsewhere.
            double position = 0.0, term = t * t / 2.0;
            for (int order = 3; order < 60; ++order) {
                position += term;
                term *= -t / order;
            }
            const Eigen::Vector3d response(position, -std::expm1(-t), std::exp(-t));
            sum += 2.0 * half * weights[std::abs(k)] * response * response.transpose();
        }
    }
    return sum;
}

/// Largest difference of elements, each relative to the geometric mean of its diagonal elements.
double scaled_difference(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    double worst = 0.0;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            worst = std::max(worst, std::fabs(a(r, c) - b(r, c)) / std::sqrt(b(r, r) * b(c, c)));
    return worst;
}

}  // namespace

TEST_CASE("the exact Singer model agrees with the reference library", "[motion]") {
    const auto answers = reference("models_and_filters.json");
    for (const double dt : {0.5, 2.0}) {
        const auto& answer =
            answers.at(dt == 0.5 ? "Singer q=0.01 alpha=0.1 dt=0.5" : "Singer q=0.01 alpha=0.1 dt=2.0");
        // There q = 2 alpha sigma^2.
        const double variance = 0.01 / (2.0 * 0.1);  // 0.2236...^2
        CHECK(relative_difference(singer::exact_transition(0.1, dt), matrix(answer.at("F"))) < 1e-12);
        CHECK(relative_difference(variance * singer::exact_noise(0.1, dt), matrix(answer.at("Q"))) < 1e-9);
        const Instance instance(
            "motion", "singer",
            {{"dimension", "1"}, {"maneuver_rate", "0.1 1/s"}, {"acceleration", "0.22360679774997896 m/s2"}});
        CHECK(relative_difference(MotionUnderTest(instance).jacobian(dt), matrix(answer.at("F"))) < 1e-12);
        CHECK(relative_difference(MotionUnderTest(instance).noise(dt), matrix(answer.at("Q"))) <
              1e-5);  // six digits given
    }
}

TEST_CASE("the exact Singer noise is the integral that defines it, whatever alpha T", "[motion]") {
    for (const double a : {1e-3, 0.1, 0.5, 0.999999, 1.0, 1.000001, 2.0, 5.0, 12.0})
        CHECK(scaled_difference(singer::exact_noise(1.0, a), integrated_noise(a)) < 1e-13);
}

TEST_CASE("the exact Singer model becomes that of constant acceleration as alpha T vanishes", "[motion]") {
    const double rate = 1e-9, dt = 2.0;
    CHECK(relative_difference(singer::exact_transition(rate, dt), constant_acceleration::transition(dt)) < 1e-8);
    const Eigen::Matrix3d limit = 2.0 * rate * constant_acceleration::continuous_noise(dt);
    CHECK(scaled_difference(singer::exact_noise(rate, dt), limit) < 1e-8);
    CHECK(singer::exact_noise(rate, 0.0).isZero(0.0));
}

TEST_CASE("the exact Singer model forgets its acceleration and keeps its variance", "[motion]") {
    const Eigen::Matrix3d f = singer::exact_transition(0.5, 200.0), q = singer::exact_noise(0.5, 200.0);
    CHECK(f(2, 2) < 1e-40);
    CHECK(q(2, 2) == Approx(1.0).epsilon(1e-14));
    CHECK(f(1, 2) == Approx(2.0).epsilon(1e-14));  // 1 / alpha
}

TEST_CASE("Singer models keep what their flags and extensions promise", "[motion]") {
    for (const char* const dimension : {"1", "2", "3"}) {
        const Instance exact("motion", "singer",
                             {{"dimension", dimension}, {"maneuver_rate", "0.3"}, {"acceleration", "2"}});
        check_linear_motion(MotionUnderTest(exact), 0.7, 2.3);
        CHECK(MotionUnderTest(exact).structure() != nullptr);
        CHECK((MotionUnderTest(exact).flags() & PLR_MOTION_BACKWARD) != 0);
        const Instance truncated(
            "motion", "singer",
            {{"dimension", dimension}, {"form", "truncated"}, {"maneuver_rate", "0.3"}, {"acceleration", "2"}});
        check_linear_motion(MotionUnderTest(truncated), 0.7, 2.3);
        CHECK(MotionUnderTest(truncated).structure() != nullptr);
        CHECK(MotionUnderTest(truncated).factor(0.7).cols() == std::atoi(dimension));
        CHECK((MotionUnderTest(truncated).flags() & PLR_MOTION_BACKWARD) == 0);
    }
}

TEST_CASE("the truncated Singer model is the airship paper's", "[motion]") {
    const Instance instance(
        "motion", "singer",
        {{"dimension", "1"}, {"form", "truncated"}, {"maneuver_rate", "0.1"}, {"acceleration", "0.1"}});
    Eigen::Matrix3d f, q;
    f << 1.0, 1.0, 0.5, 0.0, 1.0, 1.0, 0.0, 0.0, std::exp(-0.1);
    q << 0.25, 0.5, 0.5, 0.5, 1.0, 1.0, 0.5, 1.0, 1.0;
    CHECK(relative_difference(MotionUnderTest(instance).jacobian(1.0), f) < 1e-15);
    CHECK(relative_difference(MotionUnderTest(instance).noise(1.0), 0.01 * q) < 1e-15);
}

TEST_CASE("Singer's acceleration is its own prior unless another is given", "[motion]") {
    const Instance own("motion", "singer", {{"dimension", "2"}, {"acceleration", "[3, 4]"}});
    CHECK(MotionUnderTest(own).component(4).prior_deviation == 4.0);
    const Instance given("motion", "singer",
                         {{"dimension", "2"}, {"acceleration", "3"}, {"prior_acceleration", "0.5"}});
    CHECK(MotionUnderTest(given).component(4).prior_deviation == 0.5);
    try {
        const Instance none("motion", "singer", {{"acceleration", "0"}});
        FAIL("an acceleration of 0 leaves no prior");
    } catch (const Refused& error) {
        CHECK(error.where == "prior_acceleration");
    }
}
