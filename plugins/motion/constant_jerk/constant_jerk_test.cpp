#include "../../../tests/support/motion_checks.hpp"
#include "../../../tests/support/reference.hpp"
#include "constant_jerk_model.hpp"

using namespace test_support;

TEST_CASE("constant jerk agrees with the reference library", "[motion]") {
    const auto answers = reference("models_and_filters.json");
    for (const double dt : {0.5, 2.0}) {
        const auto& answer =
            answers.at(dt == 0.5 ? "Jerk (3rd derivative) q=0.2 dt=0.5" : "Jerk (3rd derivative) q=0.2 dt=2.0");
        const Instance instance("motion", "constant_jerk", {{"dimension", "1"}, {"noise", "0.2 m2/s7"}});
        const MotionUnderTest motion(instance);
        CHECK(relative_difference(motion.jacobian(dt), matrix(answer.at("F"))) < 1e-14);
        const Eigen::MatrixXd q = motion.noise(dt), expected = matrix(answer.at("Q"));
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) CHECK(q(r, c) == Approx(expected(r, c)).epsilon(1e-13));
    }
}

TEST_CASE("constant jerk keeps what its flags and extensions promise", "[motion]") {
    for (const char* const dimension : {"1", "2", "3"}) {
        const Instance continuous("motion", "constant_jerk", {{"dimension", dimension}, {"noise", "2.5"}});
        check_linear_motion(MotionUnderTest(continuous), 0.7, 2.3);
        CHECK(MotionUnderTest(continuous).structure() != nullptr);
        CHECK(MotionUnderTest(continuous).factor(0.7).size() == 0);
        const Instance discrete("motion", "constant_jerk",
                                {{"dimension", dimension}, {"form", "discrete"}, {"jerk", "1.5"}});
        check_linear_motion(MotionUnderTest(discrete), 0.7, 2.3);
        CHECK(MotionUnderTest(discrete).structure() != nullptr);
        CHECK(MotionUnderTest(discrete).factor(0.7).cols() == std::atoi(dimension));
    }
}

TEST_CASE("a discrete increment of the jerk moves a target as a constant jerk does", "[motion]") {
    const Instance instance("motion", "constant_jerk", {{"dimension", "1"}, {"form", "discrete"}, {"jerk", "3"}});
    const Eigen::MatrixXd q = MotionUnderTest(instance).noise(2.0);
    CHECK(q(0, 0) == Approx(16.0));  // (3 x 8 / 6)^2
    CHECK(q(1, 1) == Approx(36.0));
    CHECK(q(2, 2) == Approx(36.0));
    CHECK(q(3, 3) == Approx(9.0));
    CHECK(q(0, 3) == Approx(12.0));
}

TEST_CASE("constant jerk names its components and refuses the other form's parameter", "[motion]") {
    const Instance instance("motion", "constant_jerk", {{"dimension", "2"}, {"prior_jerk", "0.5"}});
    const MotionUnderTest motion(instance);
    REQUIRE(motion.size() == 8);
    CHECK(std::string(motion.component(7).name) == "jerk.y");
    CHECK(std::string(motion.component(7).unit) == "m/s3");
    CHECK(motion.component(7).prior_deviation == 0.5);
    CHECK(motion.component(4).prior_deviation == 10.0);
    const auto refused = [](const Values& values) {
        try {
            const Instance bad("motion", "constant_jerk", values);
        } catch (const Refused& error) {
            return error.where;
        }
        return std::string("accepted");
    };
    CHECK(refused({{"jerk", "1"}}) == "jerk");
    CHECK(refused({{"form", "discrete"}, {"noise", "1"}}) == "noise");
}
