#include "../../../tests/support/motion_checks.hpp"
#include "../../../tests/support/reference.hpp"
#include "constant_velocity_model.hpp"

using namespace test_support;

TEST_CASE("constant velocity agrees with the reference library", "[motion]") {
    const auto answers = reference("models_and_filters.json");
    for (const double dt : {0.5, 2.0}) {
        const auto& answer = answers.at(dt == 0.5 ? "CV q=0.5 dt=0.5" : "CV q=0.5 dt=2.0");
        CHECK(relative_difference(constant_velocity::transition(dt), matrix(answer.at("F"))) < 1e-14);
        CHECK(relative_difference(0.5 * constant_velocity::continuous_noise(dt), matrix(answer.at("Q"))) < 1e-14);
        const Instance instance("motion", "constant_velocity", {{"dimension", "1"}, {"noise", "0.5 m2/s3"}});
        const MotionUnderTest motion(instance);
        CHECK(relative_difference(motion.jacobian(dt), matrix(answer.at("F"))) < 1e-14);
        CHECK(relative_difference(motion.noise(dt), matrix(answer.at("Q"))) < 1e-14);
    }
}

TEST_CASE("constant velocity keeps what its flags and extensions promise", "[motion]") {
    for (const char* const dimension : {"1", "2", "3"}) {
        const Instance continuous("motion", "constant_velocity", {{"dimension", dimension}, {"noise", "2.5"}});
        check_linear_motion(MotionUnderTest(continuous), 0.7, 2.3);
        CHECK(MotionUnderTest(continuous).structure() != nullptr);
        CHECK(MotionUnderTest(continuous).factor(0.7).size() == 0);
        const Instance discrete("motion", "constant_velocity",
                                {{"dimension", dimension}, {"form", "discrete"}, {"acceleration", "1.5"}});
        check_linear_motion(MotionUnderTest(discrete), 0.7, 2.3);
        CHECK(MotionUnderTest(discrete).factor(0.7).cols() == std::atoi(dimension));
    }
}

TEST_CASE("a discrete acceleration moves a constant-velocity target as a constant acceleration would", "[motion]") {
    const Instance instance("motion", "constant_velocity",
                            {{"dimension", "1"}, {"form", "discrete"}, {"acceleration", "3"}});
    const Eigen::MatrixXd q = MotionUnderTest(instance).noise(4.0);
    CHECK(q(0, 0) == Approx(24.0 * 24.0));  // half of 3 m/s2 times 16 s2
    CHECK(q(0, 1) == Approx(24.0 * 12.0));
    CHECK(q(1, 1) == Approx(12.0 * 12.0));
}

TEST_CASE("constant velocity takes one noise an axis", "[motion]") {
    const Instance instance("motion", "constant_velocity", {{"dimension", "2"}, {"noise", "[1, 4]"}});
    const MotionUnderTest motion(instance);
    CHECK(motion.structure() == nullptr);  // Q is not Q1 (x) I
    check_linear_motion(motion, 0.7, 2.3);
    const Eigen::MatrixXd q = motion.noise(3.0);
    CHECK(q(2, 2) == Approx(3.0));
    CHECK(q(3, 3) == Approx(12.0));
    CHECK(q(0, 2) == Approx(4.5));
    CHECK(q(0, 1) == 0.0);
    CHECK(q(0, 3) == 0.0);
}

TEST_CASE("constant velocity names its components and what is taken for the unknown ones", "[motion]") {
    const Instance instance("motion", "constant_velocity", {{"dimension", "2"}, {"prior_velocity", "15 m/s"}});
    const MotionUnderTest motion(instance);
    REQUIRE(motion.size() == 4);
    CHECK(std::string(motion.component(1).name) == "position.y");
    CHECK(std::string(motion.component(2).name) == "velocity.x");
    CHECK(std::string(motion.component(2).unit) == "m/s");
    CHECK(motion.component(0).prior_deviation == 1e6);
    CHECK(motion.component(2).prior_deviation == 15.0);
}

TEST_CASE("constant velocity among accelerations moves by velocity alone and draws the acceleration anew", "[motion]") {
    const Instance instance("motion", "constant_velocity",
                            {{"dimension", "2"},
                             {"form", "discrete"},
                             {"acceleration", "0.1 m/s2"},
                             {"acceleration_deviation", "0.001 m/s2"}});
    const MotionUnderTest motion(instance);
    REQUIRE(motion.size() == 6);
    CHECK(std::string(motion.component(5).name) == "acceleration.y");
    CHECK(motion.component(5).prior_deviation == 0.001);
    Eigen::VectorXd x(6), expected(6);
    x << 1.0, 2.0, 10.0, -20.0, 5.0, 7.0;
    expected << 21.0, -38.0, 10.0, -20.0, 0.0, 0.0;
    CHECK(motion.propagate(2.0, x) == expected);
    // 0.1^2 h h' with h = [T^2/2; T], and 1e-6 on the acceleration.
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(6, 6);
    for (int axis = 0; axis < 2; ++axis) {
        q(axis, axis) = q(2 + axis, 2 + axis) = 0.04;
        q(axis, 2 + axis) = q(2 + axis, axis) = 0.04;
        q(4 + axis, 4 + axis) = 1e-6;
    }
    CHECK(relative_difference(motion.noise(2.0), q) < 1e-15);
    CHECK(motion.factor(2.0).cols() == 4);
}

TEST_CASE("constant velocity among accelerations keeps what its flags and extensions promise", "[motion]") {
    for (const char* const dimension : {"1", "2", "3"}) {
        for (const char* const form : {"continuous", "discrete"}) {
            const Instance instance("motion", "constant_velocity",
                                    {{"dimension", dimension}, {"form", form}, {"acceleration_deviation", "2 m/s2"}});
            const MotionUnderTest motion(instance);
            check_linear_motion(motion, 0.7, 2.3);
            CHECK((motion.flags() & PLR_MOTION_BACKWARD) == 0);
            CHECK(motion.structure() != nullptr);
            CHECK(motion.jacobian(0.0).isIdentity(0.0));
            CHECK(motion.noise(0.0).isZero(0.0));
        }
    }
    const Instance uneven("motion", "constant_velocity",
                          {{"dimension", "2"}, {"noise", "[1, 4]"}, {"acceleration_deviation", "2 m/s2"}});
    CHECK(MotionUnderTest(uneven).structure() == nullptr);
    check_linear_motion(MotionUnderTest(uneven), 0.7, 2.3);
}

TEST_CASE("constant velocity refuses parameters that do not belong together", "[motion]") {
    const auto refused = [](const Values& values) {
        try {
            const Instance instance("motion", "constant_velocity", values);
        } catch (const Refused& error) {
            return error.where;
        }
        return std::string("accepted");
    };
    CHECK(refused({{"acceleration", "1"}}) == "acceleration");
    CHECK(refused({{"form", "discrete"}, {"noise", "1"}}) == "noise");
    CHECK(refused({{"dimension", "3"}, {"noise", "[1, 2]"}}) == "noise");
    CHECK(refused({{"form", "discrete"}, {"acceleration", "1"}}) == "accepted");
}

TEST_CASE("a step of constant velocity to an infinite time fails its item alone", "[motion]") {
    const Instance instance("motion", "constant_velocity", {{"dimension", "1"}});
    const auto motion = instance.as<pelorus::MotionPart>();
    Call call(3);
    const double dt[] = {1.0, std::numeric_limits<double>::infinity(), 2.0};
    const double state[] = {0.0, 1.0, 0.0, 1.0, 0.0, 1.0};
    Batch out(2, 1, 3);
    auto args = pelorus::arguments<plr_motion_propagate>();
    args.dt = pelorus::const_view(dt, 1, 1, 3);
    args.state = pelorus::const_view(state, 2, 1, 3);
    args.out = out.out();
    CHECK(motion.call(&plr_motion::propagate, call, args) == PLR_ITEMS_FAILED);
    CHECK(call.status(0) == PLR_OK);
    CHECK(call.status(1) == PLR_E_NUMERIC);
    CHECK(call.status(2) == PLR_OK);
    CHECK(call.error().item == 1);
    CHECK(out[2](0) == 2.0);
}
