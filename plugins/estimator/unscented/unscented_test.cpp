// The unscented filter against the step of an established library, and its parameters. What holds for all point filters is tested
// beside their engine.
#include "../../../tests/support/reference_step.hpp"

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST_CASE("the unscented filter's step agrees with the reference library", "[unscented]") {
    check_reference_step("unscented", {{"alpha", "0.5"}, {"kappa", "-3"}},
                         "filter UKF alpha=0.5 beta=2 kappa=-3 (n+kappa=3)");
}

TEST_CASE("with alpha 1, beta 0 and kappa 0 the unscented filter is the cubature filter", "[unscented]") {
    FilterUnderTest f("unscented", {{"beta", "0"}}, "constant_velocity", {}, "spherical");
    FilterUnderTest cubature("cubature", {}, "constant_velocity", {}, "spherical");
    const VectorXd x = (VectorXd(6) << 300.0, 400.0, 100.0, 1.0, 2.0, 3.0).finished();
    const MatrixXd p = 900.0 * MatrixXd::Identity(6, 6), noise = Eigen::Vector3d(100.0, 1e-4, 1e-4).asDiagonal();
    const Batch a = f.updated(Eigen::Vector3d(510.0, 0.9, 0.2), noise, f.record_of(x, p));
    const Batch b = cubature.updated(Eigen::Vector3d(510.0, 0.9, 0.2), noise, cubature.record_of(x, p));
    CHECK(relative(f.mean(a), cubature.mean(b)) < 1e-13);
    CHECK(relative(f.covariance(a), cubature.covariance(b)) < 1e-12);
}

TEST_CASE("the unscented filter refuses a kappa that leaves no points", "[unscented]") {
    try {
        const FilterUnderTest f("unscented", {{"kappa", "-4"}}, "constant_velocity", {{"dimension", "2"}}, "position",
                                {{"dimension", "2"}});
        FAIL("was accepted");
    } catch (const Refused& error) {
        CHECK(error.where == "kappa");
        CHECK(std::string(error.what()) ==
              "is -4, expected more than -4: n + kappa must be positive, and motion.constant_velocity has n = 4 "
              "components");
    }
}
