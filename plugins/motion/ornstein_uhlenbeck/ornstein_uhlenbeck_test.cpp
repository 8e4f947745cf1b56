#include "../../../tests/support/motion_checks.hpp"
#include "../../../tests/support/reference.hpp"

using namespace test_support;

namespace {

Instance line(const char* rate, const char* noise) {
    return {"motion", "ornstein_uhlenbeck", {{"dimension", "1"}, {"decay_rate", rate}, {"noise", noise}}};
}

/// Q by Van Loan's exponential of the block matrix [-A G; 0 A'] T, of the continuous model x' = A x + white noise of density G:
/// its right blocks are F^-1 Q and F'. C. F. Van Loan, Computing integrals involving the matrix exponential, IEEE Transactions on Automatic Control
/// 23(3), 395-404, 1978. Steps are halved until the series needs few terms.
Eigen::Matrix2d van_loan_noise(double rate, double density, double dt) {
    Eigen::Matrix4d block = Eigen::Matrix4d::Zero();
    block(0, 1) = -1.0;
    block(1, 1) = rate;
    block(1, 3) = density;
    block(3, 2) = 1.0;
    block(3, 3) = -rate;
    constexpr int halvings = 10;
    block *= dt / (1 << halvings);
    Eigen::Matrix4d exponential = Eigen::Matrix4d::Identity(), term = exponential;
    for (int k = 1; k < 30; ++k) {
        term = term * block / k;
        exponential += term;
    }
    for (int k = 0; k < halvings; ++k) exponential = (exponential * exponential).eval();
    return exponential.bottomRightCorner<2, 2>().transpose() * exponential.topRightCorner<2, 2>();
}

}  // namespace

TEST_CASE("the Ornstein-Uhlenbeck velocity agrees with the reference library", "[motion]") {
    const auto answers = reference("models_and_filters.json");
    const Instance instance = line("0.1 1/s", "0.5 m2/s3");
    const MotionUnderTest motion(instance);
    for (const double dt : {0.5, 2.0}) {
        const auto& answer = answers.at(dt == 0.5 ? "OU q=0.5 damping=0.1 dt=0.5" : "OU q=0.5 damping=0.1 dt=2.0");
        CHECK(relative_difference(motion.jacobian(dt), matrix(answer.at("F"))) < 1e-14);
        CHECK(relative_difference(motion.noise(dt), matrix(answer.at("Q"))) < 1e-12);
    }
}

TEST_CASE("the Ornstein-Uhlenbeck noise is Van Loan's integral", "[motion]") {
    for (const double dt : {0.05, 0.5, 1.0, 3.0}) {
        const Instance instance = line("0.8 1/s", "2 m2/s3");
        CHECK(relative_difference(MotionUnderTest(instance).noise(dt), van_loan_noise(0.8, 2.0, dt)) < 1e-11);
    }
}

TEST_CASE("the Ornstein-Uhlenbeck velocity keeps what its flags and extensions promise", "[motion]") {
    for (const char* const dimension : {"1", "2", "3"}) {
        const Instance instance("motion", "ornstein_uhlenbeck", {{"dimension", dimension}, {"decay_rate", "0.3"}});
        check_linear_motion(MotionUnderTest(instance), 0.7, 2.3);
        CHECK(MotionUnderTest(instance).structure() != nullptr);
    }
}

TEST_CASE("the Ornstein-Uhlenbeck speed stays bounded, and the position diffuses", "[motion]") {
    const Instance instance = line("0.5 1/s", "3 m2/s3");
    const Eigen::MatrixXd hour = MotionUnderTest(instance).noise(3600.0), two = MotionUnderTest(instance).noise(7200.0);
    CHECK(hour(1, 1) == Approx(3.0));  // q / (2 r)
    CHECK(two(1, 1) == Approx(3.0));
    CHECK(two(0, 0) - hour(0, 0) == Approx(3.0 / 0.25 * 3600.0));  // q / r^2 a second
}

TEST_CASE("a velocity that hardly decays is nearly constant", "[motion]") {
    const Instance slow = line("0.000000001 1/s", "1 m2/s3");
    const Instance constant("motion", "constant_velocity", {{"dimension", "1"}});
    CHECK(relative_difference(MotionUnderTest(slow).jacobian(2.0), MotionUnderTest(constant).jacobian(2.0)) < 1e-8);
    CHECK(relative_difference(MotionUnderTest(slow).noise(2.0), MotionUnderTest(constant).noise(2.0)) < 1e-8);
}
