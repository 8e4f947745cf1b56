#include <catch2/catch.hpp>
#include <cmath>

#include <pelorus/failure.hpp>

#include "local_fit.hpp"

namespace {

using namespace calibration;

/// 2 m + 1 times with a spacing of 1 s, unit variances.
FitInput symmetric(int m) {
    FitInput out;
    for (int i = -m; i <= m; ++i) out.times.push_back(i);
    out.values = Eigen::MatrixXd::Zero(1, 2 * m + 1);
    out.variances = Eigen::MatrixXd::Ones(1, 2 * m + 1);
    return out;
}

}  // namespace

TEST_CASE("local fit: a parabola is found again, whatever the times", "[registration]") {
    FitInput input;
    input.times = {-0.31, -0.2, -0.05, 0.02, 0.4, 0.55};
    input.values.resize(2, 6);
    input.variances = Eigen::MatrixXd::Constant(2, 6, 1e-10);
    for (int i = 0; i < 6; ++i) {
        const double t = input.times[static_cast<std::size_t>(i)];
        input.values(0, i) = 3 - 2 * t + 5 * t * t;
        input.values(1, i) = 1e-3 + 4e-3 * t;
    }
    const Fit fit = local_fit(input);
    CHECK(fit.value(0) == Approx(3).epsilon(1e-12));
    CHECK(fit.rate(0) == Approx(-2).epsilon(1e-12));
    CHECK(fit.value(1) == Approx(1e-3).epsilon(1e-12));
    CHECK(fit.rate(1) == Approx(4e-3).epsilon(1e-12));
    CHECK(fit.freedom == 6);
    CHECK(fit.squared < 1e-6);
}

TEST_CASE("local fit: variances are those of the smoothing formulas for equal spacing", "[registration]") {
    // A. Savitzky, M. J. E. Golay, Analytical Chemistry 36(8), 1964: the smoothed value in the middle has
    // 3 (3 m^2 + 3 m - 1) / ((2 m - 1)(2 m + 1)(2 m + 3)) of the variance, its slope 3 / (m (m + 1)(2 m + 1)).
    const int m = GENERATE(1, 2, 5, 10);
    const Fit fit = local_fit(symmetric(m));
    CHECK(fit.value_variance(0) ==
          Approx(3.0 * (3 * m * m + 3 * m - 1) / ((2 * m - 1.0) * (2 * m + 1) * (2 * m + 3))).epsilon(1e-10));
    CHECK(fit.rate_variance(0) == Approx(3.0 / (m * (m + 1.0) * (2 * m + 1))).epsilon(1e-10));
}

TEST_CASE("local fit: what does not lie on a parabola shows in the residuals", "[registration]") {
    FitInput input = symmetric(2);
    input.values(0, 0) = 100;
    CHECK(local_fit(input).squared > 100);
    CHECK(local_fit(input).freedom == 2);
}

TEST_CASE("local fit: times that determine nothing are refused", "[registration]") {
    FitInput two = symmetric(1);
    two.times.pop_back();
    two.values.conservativeResize(1, 2);
    two.variances.conservativeResize(1, 2);
    CHECK_THROWS_AS(local_fit(two), pelorus::NumericError);
    FitInput same = symmetric(1);
    same.times = {1, 1, 2};
    CHECK_THROWS_AS(local_fit(same), pelorus::NumericError);
}
