#include "../../../tests/support/motion_at.hpp"
#include "../../../tests/support/reference.hpp"

using namespace test_support;

namespace {

constexpr double pi = 3.14159265358979323846;

}  // namespace

TEST_CASE("a coordinated turn of known rate agrees with the reference library", "[motion][turn]") {
    const auto answers = reference("models_and_filters.json");
    for (const std::string dt : {"0.5", "2.0"}) {
        const auto& answer = answers.at("KnownTurnRate q=[0.1,0.1] w=0.05 dt=" + dt);
        const Instance turn("motion", "coordinated_turn",
                            {{"dimension", "2"}, {"turn_rate", "0.05"}, {"noise", "0.1"}});
        const std::vector<int> order{0, 2, 1, 3};  // there x, vx, y, vy
        const MotionUnderTest motion(turn);
        CHECK(relative_difference(motion.jacobian(std::stod(dt)), reordered(matrix(answer.at("F")), order, order)) <
              1e-14);
        CHECK(relative_difference(motion.noise(std::stod(dt)), reordered(matrix(answer.at("Q")), order, order)) <
              1e-14);
    }
}

TEST_CASE("a coordinated turn of estimated rate agrees with the reference library", "[motion][turn]") {
    const auto answer = reference("models_and_filters.json").at("ConstantTurn [x,vx,y,vy,w] dt=1");
    const Instance turn("motion", "coordinated_turn",
                        {{"dimension", "2"}, {"noise", "0.1"}, {"turn_rate_noise", "0.01"}});
    const std::vector<int> order{0, 2, 1, 3, 4};
    const MotionAt motion(turn);
    const Eigen::VectorXd x = reordered(matrix(answer.at("x")), order, {0});
    CHECK(relative_difference(motion.propagate(1.0, x), reordered(matrix(answer.at("f")), order, {0})) < 1e-14);
    // Its Jacobian is one of finite differences.
    CHECK(relative_difference(motion.jacobian(1.0, x), reordered(matrix(answer.at("J")), order, order)) < 1e-7);
    CHECK(relative_difference(motion.noise(1.0, x), reordered(matrix(answer.at("Q")), order, order)) < 1e-14);
}

TEST_CASE("a coordinated turn draws a circle and climbs as it did", "[motion][turn]") {
    const Instance turn("motion", "coordinated_turn");
    const MotionAt motion(turn);
    Eigen::VectorXd x(7), quarter(7);
    const double w = 0.1, radius = 1000.0;  // from (radius, 0) about the origin, towards +y
    x << radius, 0.0, 300.0, 0.0, w * radius, -5.0, w;
    const double dt = pi / 2.0 / w;
    quarter << 0.0, radius, 300.0 - 5.0 * dt, -w * radius, 0.0, -5.0, w;
    CHECK((motion.propagate(dt, x) - quarter).norm() < 1e-9);
    CHECK((motion.propagate(-dt, quarter) - x).norm() < 1e-9);
    x(6) = 0.0;  // straight on
    CHECK(motion.propagate(2.0, x)(1) == 2.0 * w * radius);
}

TEST_CASE("the Jacobian of a coordinated turn is its derivative at any turn", "[motion][turn]") {
    for (const char* const dimension : {"2", "3"}) {
        const Instance turn("motion", "coordinated_turn", {{"dimension", dimension}});
        const MotionAt motion(turn);
        Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(motion.size(), 300.0, -150.0);
        for (const double rate : {0.0, 1e-12, 1e-9, 1e-6, 1e-4, -1e-3, 0.01, 0.1, -0.999999, 1.0, 1.000001, 3.0, 20.0})
            for (const double dt : {1.0, -1.0, 7.5}) {
                x(motion.size() - 1) = rate;
                CHECK(motion.jacobian_error(dt, x) < 1e-8);
            }
    }
}

TEST_CASE("the change with the turn rate is accurate where its printed form cancels", "[motion][turn]") {
    // By the series in long double about w = 0: d/dw of x' is -T^2 vy / 2 - T^3 w vx / 3 + T^4 w^2 vy / 8 + ...
    const Instance turn("motion", "coordinated_turn", {{"dimension", "2"}});
    Eigen::VectorXd x(5);
    x << 0.0, 0.0, 200.0, 0.0, 0.0;
    for (const double w : {1e-8, 1e-5, 1e-3}) {
        x(4) = w;
        const double t = 2.0;
        const double expected = -t * t * t * w * 200.0 / 3.0 * (1.0 - w * w * t * t / 10.0);
        CHECK(MotionAt(turn).jacobian(t, x)(0, 4) == Approx(expected).epsilon(1e-11));
    }
}

TEST_CASE("coordinated turns keep what their flags promise", "[motion][turn]") {
    for (const char* const dimension : {"2", "3"}) {
        const Instance known("motion", "coordinated_turn",
                             {{"dimension", dimension}, {"turn_rate", "0.3"}, {"noise", "2"}});
        check_linear_motion(MotionUnderTest(known), 0.7, 2.3);
        CHECK(MotionUnderTest(known).structure() == nullptr);  // axes are coupled
    }
    const Instance estimated("motion", "coordinated_turn", {{"noise", "[1, 2, 3]"}, {"turn_rate_noise", "0.01"}});
    const MotionAt motion(estimated);
    CHECK((MotionUnderTest(estimated).flags() & (PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE)) == 0);
    Eigen::VectorXd x(7);
    x << 1.0, 2.0, 3.0, 40.0, -50.0, 6.0, 0.2;
    const Eigen::VectorXd later = motion.propagate(3.0, x);
    CHECK((motion.propagate(-3.0, later) - x).norm() < 1e-11);
    CHECK(relative_difference(motion.jacobian(2.0, later) * motion.jacobian(3.0, x), motion.jacobian(5.0, x)) < 1e-13);
    const Eigen::MatrixXd back = motion.jacobian(-3.0, later);
    CHECK(relative_difference(motion.noise(-3.0, later), back * motion.noise(3.0, x) * back.transpose()) < 1e-13);
}

TEST_CASE("what belongs to an estimated turn rate is refused with a known one", "[motion][turn]") {
    for (const char* const parameter : {"turn_rate_noise", "prior_turn_rate"}) {
        try {
            const Instance both("motion", "coordinated_turn", {{"turn_rate", "0.1"}, {parameter, "0.1"}});
            FAIL("a known rate has neither noise nor prior");
        } catch (const Refused& refused) {
            CHECK(refused.where == parameter);
        }
    }
    CHECK_THROWS_AS(Instance("motion", "coordinated_turn", {{"noise", "[1, 2]"}}), Refused);
}
