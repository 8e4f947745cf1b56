// Rules against moments of the normal distribution, E x^2k = 1 3 5 ... (2k - 1).
#include "point_rule.hpp"

#include <cmath>
#include <functional>

#include <catch2/catch.hpp>

using namespace gaussian;

namespace {

double sum(const PointRule& rule, const std::function<double(const double*)>& f, bool covariance = false) {
    double total = 0.0;
    for (std::int64_t p = 0; p < rule.count(); ++p)
        total +=
            (covariance ? rule.covariance_weights : rule.mean_weights)[static_cast<std::size_t>(p)] * f(rule.point(p));
    return total;
}

void check_second_moments(const PointRule& rule) {
    CHECK(sum(rule, [](const double*) { return 1.0; }) == Approx(1.0).epsilon(1e-13));
    for (std::int64_t a = 0; a < rule.size; ++a) {
        CHECK(std::fabs(sum(rule, [&](const double* x) { return x[a]; })) < 1e-14);
        CHECK(std::fabs(sum(rule, [&](const double* x) { return x[a] * x[a] * x[a]; })) < 1e-13);
        for (std::int64_t b = 0; b < rule.size; ++b)
            CHECK(sum(rule, [&](const double* x) { return x[a] * x[b]; }) == Approx(a == b ? 1.0 : 0.0).margin(1e-13));
    }
}

}  // namespace

TEST_CASE("every rule has the mean and covariance of the normal distribution", "[gaussian]") {
    for (const PointRule& rule : {cubature_rule(4), unscented_rule(6, 0.5, 2.0, -3.0), unscented_rule(3, 1.0, 0.0, 0.5),
                                  gauss_hermite_rule(2, 2), gauss_hermite_rule(3, 3), gauss_hermite_rule(1, 32)}) {
        check_second_moments(rule);
        for (std::int64_t k = 1; k < rule.size; ++k) check_second_moments(leading_rule(rule, k));
        for (std::int64_t r = 0; r < rule.size; ++r) CHECK(rule.point(0)[r] == 0.0);  // the centre
    }
}

TEST_CASE("the cubature rule has 2n points of one weight at the root of n", "[gaussian]") {
    const PointRule rule = cubature_rule(6);
    REQUIRE(rule.count() == 13);
    CHECK(rule.mean_weights[0] == 0.0);
    for (std::size_t p = 1; p < 13; ++p) CHECK(rule.mean_weights[p] == Approx(1.0 / 12.0));
    CHECK(rule.point(1)[0] == std::sqrt(6.0));
    CHECK(rule.point(4)[1] == -std::sqrt(6.0));
    CHECK(sum(rule, [](const double* x) { return std::pow(x[0], 4); }) == Approx(6.0));  // not 3: degree 3 it is
}

TEST_CASE("weights of the unscented transform are the published ones", "[gaussian]") {
    // n = 3, kappa = 0, alpha = 0.5, beta = 2: lambda = 0.75 - 3 = -2.25.
    const PointRule rule = unscented_rule(3, 0.5, 2.0, 0.0);
    CHECK(rule.mean_weights[0] == Approx(-3.0));
    CHECK(rule.covariance_weights[0] == Approx(-3.0 + 1.0 - 0.25 + 2.0));
    CHECK(rule.mean_weights[1] == Approx(1.0 / 1.5));
    CHECK(rule.point(1)[0] == Approx(std::sqrt(0.75)));
    // With kappa = 3 - n the fourth moment is exact (Julier and Uhlmann).
    const PointRule fourth = unscented_rule(2, 1.0, 0.0, 1.0);
    CHECK(sum(fourth, [](const double* x) { return std::pow(x[1], 4); }) == Approx(3.0));
}

TEST_CASE("a Gauss-Hermite rule is exact up to degree 2 order - 1", "[gaussian]") {
    for (const int order : {2, 3, 5, 10, 20}) {
        CAPTURE(order);
        const PointRule rule = gauss_hermite_rule(1, order);
        double expected = 1.0;
        for (int k = 1; k < order; ++k) {
            expected *= 2 * k - 1;
            CHECK(sum(rule, [&](const double* x) { return std::pow(x[0], 2 * k); }) == Approx(expected).epsilon(1e-11));
        }
    }
    const PointRule grid = gauss_hermite_rule(2, 3);
    CHECK(grid.count() == 9);
    CHECK(grid.mean_weights[0] == Approx(4.0 / 9.0));
    CHECK(sum(grid, [](const double* x) { return std::pow(x[0], 4) * x[1] * x[1]; }) == Approx(3.0));
    // The roots of x^3 - 3 x with weights 1/6, 2/3, 1/6 (Abramowitz, Stegun, 25.10, rescaled).
    const PointRule three = gauss_hermite_rule(1, 3);
    CHECK(std::fabs(three.point(1)[0]) == Approx(std::sqrt(3.0)));
    CHECK(three.mean_weights[1] == Approx(1.0 / 6.0));
    CHECK(gauss_hermite_rule(2, 4).count() == 17);  // and a centre of no weight
}

TEST_CASE("points that differ in later components only are one", "[gaussian]") {
    const PointRule star = leading_rule(cubature_rule(6), 3);
    CHECK(star.count() == 7);
    CHECK(star.is_star);
    CHECK(star.mean_weights[0] == Approx(0.5));
    CHECK(star.mean_weights[1] == Approx(1.0 / 12.0));
    CHECK(leading_rule(gauss_hermite_rule(6, 3), 3).count() == 27);
}
