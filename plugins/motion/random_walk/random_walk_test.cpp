#include "../../../tests/support/motion_checks.hpp"

using namespace test_support;

TEST_CASE("a random walk keeps what its flags and extensions promise", "[motion]") {
    for (const char* const dimension : {"1", "2", "3"}) {
        const Instance instance("motion", "random_walk", {{"dimension", dimension}, {"noise", "2.5"}});
        const MotionUnderTest motion(instance);
        CHECK(motion.size() == std::atoi(dimension));
        check_linear_motion(motion, 0.7, 2.3);
        CHECK(motion.structure() != nullptr);
        CHECK(motion.factor(0.7).cols() == motion.size());
    }
}

TEST_CASE("a random walk stays where it is, and its variance grows with time", "[motion]") {
    const Instance instance("motion", "random_walk",
                            {{"dimension", "2"}, {"noise", "[4, 9]"}, {"prior_position", "5"}});
    const MotionUnderTest motion(instance);
    const Eigen::Vector2d x(3.0, -7.0);
    CHECK(motion.propagate(11.0, x) == x);
    CHECK(motion.noise(2.0) == Eigen::MatrixXd(Eigen::Vector2d(8.0, 18.0).asDiagonal()));
    CHECK(motion.noise(-2.0) == motion.noise(2.0));
    CHECK(motion.structure() == nullptr);
    CHECK(std::string(motion.component(1).name) == "position.y");
    CHECK(motion.component(1).prior_deviation == 5.0);
}
