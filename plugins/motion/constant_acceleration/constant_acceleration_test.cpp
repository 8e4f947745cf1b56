#include "../../common/axis_models/constant_acceleration.hpp"
#include "../../../tests/support/waveform_trace.hpp"

using namespace test_support;

TEST_CASE("constant acceleration agrees with the reference library", "[motion]") {
    const auto answers = reference("models_and_filters.json");
    for (const double dt : {0.5, 2.0}) {
        const auto& answer = answers.at(dt == 0.5 ? "CA q=0.3 dt=0.5" : "CA q=0.3 dt=2.0");
        CHECK(relative_difference(constant_acceleration::transition(dt), matrix(answer.at("F"))) < 1e-14);
        CHECK(relative_difference(0.3 * constant_acceleration::continuous_noise(dt), matrix(answer.at("Q"))) < 1e-14);
        const Instance instance("motion", "constant_acceleration", {{"dimension", "1"}, {"noise", "0.3 m2/s5"}});
        const MotionUnderTest motion(instance);
        CHECK(relative_difference(motion.jacobian(dt), matrix(answer.at("F"))) < 1e-14);
        CHECK(relative_difference(motion.noise(dt), matrix(answer.at("Q"))) < 1e-14);
    }
}

TEST_CASE("constant acceleration keeps what its flags and extensions promise", "[motion]") {
    for (const char* const dimension : {"1", "2", "3"}) {
        const Instance continuous("motion", "constant_acceleration", {{"dimension", dimension}, {"noise", "2.5"}});
        check_linear_motion(MotionUnderTest(continuous), 0.7, 2.3);
        CHECK(MotionUnderTest(continuous).structure() != nullptr);
        const Instance discrete("motion", "constant_acceleration",
                                {{"dimension", dimension}, {"form", "discrete"}, {"acceleration", "1.5"}});
        check_linear_motion(MotionUnderTest(discrete), 0.7, 2.3);
        CHECK(MotionUnderTest(discrete).factor(0.7).cols() == std::atoi(dimension));
    }
    const Instance uneven("motion", "constant_acceleration", {{"dimension", "3"}, {"noise", "[1, 4, 0]"}});
    CHECK(MotionUnderTest(uneven).structure() == nullptr);
    CHECK(MotionUnderTest(uneven).noise(2.0)(7, 7) == Approx(8.0));
    CHECK(MotionUnderTest(uneven).noise(2.0)(8, 8) == 0.0);
}

TEST_CASE("an increment of the acceleration holds for the whole step", "[motion]") {
    const Instance instance("motion", "constant_acceleration",
                            {{"dimension", "1"}, {"form", "discrete"}, {"acceleration", "3"}});
    const Eigen::MatrixXd g = MotionUnderTest(instance).factor(4.0);
    CHECK(g(0) == 24.0);
    CHECK(g(1) == 12.0);
    CHECK(g(2) == 3.0);
}

TEST_CASE("constant acceleration orders positions, velocities, accelerations", "[motion]") {
    const Instance instance("motion", "constant_acceleration", {{"prior_acceleration", "2 m/s2"}});
    const MotionUnderTest motion(instance);
    REQUIRE(motion.size() == 9);
    CHECK(std::string(motion.component(2).name) == "position.z");
    CHECK(std::string(motion.component(3).name) == "velocity.x");
    CHECK(std::string(motion.component(8).name) == "acceleration.z");
    CHECK(std::string(motion.component(8).unit) == "m/s2");
    CHECK(motion.component(8).prior_deviation == 2.0);
}

TEST_CASE("constant acceleration by increments follows the reference's noise-free run", "[motion]") {
    const Instance instance("motion", "constant_acceleration",
                            {{"dimension", "2"}, {"form", "discrete"}, {"acceleration", "1 m/s2"}});
    check_waveform_trace(instance, "CA1");
}
