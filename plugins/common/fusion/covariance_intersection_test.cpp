#include "covariance_intersection.hpp"

#include <catch2/catch.hpp>
#include <random>

#include "../../../tests/support/reference.hpp"

namespace {

using Estimate = fusion::Estimate<6>;
using fusion::covariance_intersection;
using fusion::Criterion;

Estimate estimate(const nlohmann::json& entry) {
    return {test_support::matrix(entry.at("x")), test_support::matrix(entry.at("P"))};
}
Estimate diagonal(double first, double second) {
    Estimate out{Eigen::MatrixXd::Zero(2, 1), Eigen::MatrixXd::Zero(2, 2)};
    out.covariance(0, 0) = first;
    out.covariance(1, 1) = second;
    return out;
}
double score(const Estimate& fused, Criterion criterion) {
    if (criterion == Criterion::trace) return fused.covariance.trace();
    Eigen::MatrixXd root(fused.covariance.rows(), fused.covariance.cols());
    pelorus::small::Bounded<6, 6> lower(root.rows(), root.cols());
    REQUIRE(pelorus::small::cholesky(fused.covariance, lower));
    return pelorus::small::log_determinant(lower);
}
Eigen::MatrixXd random_square(std::mt19937& random, Eigen::Index n) {
    std::normal_distribution<double> normal;
    Eigen::MatrixXd out(n, n);
    for (Eigen::Index i = 0; i < out.size(); ++i) out.data()[i] = normal(random);
    return out;
}

}  // namespace

TEST_CASE("Covariance intersection gives the published library's estimates", "[fusion]") {
    for (const auto& [name, weight] : {std::pair{"CI weights=None", 0.5}, std::pair{"CI weights=[0.3, 0.7]", 0.3}}) {
        const auto entry = test_support::reference("models_and_filters.json").at(name);
        const Estimate both[] = {estimate(entry.at("a")), estimate(entry.at("b"))};
        const double weights[] = {weight, 1 - weight};
        Estimate fused;
        REQUIRE(covariance_intersection(both, weights, 2, fused));
        const Eigen::MatrixXd x = test_support::matrix(entry.at("x")), p = test_support::matrix(entry.at("P"));
        for (int r = 0; r < 2; ++r) {
            CHECK(fused.mean(r, 0) == Approx(x(r, 0)).epsilon(1e-12));
            for (int c = 0; c < 2; ++c) CHECK(fused.covariance(r, c) == Approx(p(r, c)).margin(1e-12));
        }
    }
}

TEST_CASE("Covariance intersection of one estimate, or of three equal ones, is that estimate", "[fusion]") {
    const Estimate one = diagonal(2, 5);
    const Estimate three[] = {one, one, one};
    const double weights[] = {0.2, 0.5, 0.3}, alone[] = {1};
    Estimate fused;
    REQUIRE(covariance_intersection(three, weights, 3, fused));
    CHECK(fused.covariance(0, 0) == Approx(2));
    CHECK(fused.covariance(1, 1) == Approx(5));
    REQUIRE(covariance_intersection(three, alone, 1, fused));
    CHECK(fused.covariance(1, 1) == Approx(5));
}

TEST_CASE("Covariance intersection finds the best weight of two estimates", "[fusion]") {
    for (const Criterion criterion : {Criterion::determinant, Criterion::trace}) {
        double weight = -1;
        Estimate fused;
        REQUIRE(covariance_intersection(diagonal(1, 4), diagonal(4, 1), criterion, weight, fused));
        CHECK(weight == Approx(0.5).epsilon(1e-12));  // by symmetry; P = (0.5 (1 + 1/4))^-1
        CHECK(fused.covariance(0, 0) == Approx(1.6));
        CHECK(fused.covariance(1, 1) == Approx(1.6));
        REQUIRE(covariance_intersection(diagonal(1, 2), diagonal(3, 4), criterion, weight, fused));
        CHECK(weight == 1);  // better in all respects
        REQUIRE(covariance_intersection(diagonal(3, 4), diagonal(1, 2), criterion, weight, fused));
        CHECK(weight == 0);
        REQUIRE(covariance_intersection(diagonal(3, 4), diagonal(3, 4), criterion, weight, fused));
        CHECK(fused.covariance(0, 0) == Approx(3));
    }
    // d/dw of -ln(w + (1-w)/9) - ln(w/4 + (1-w)) is 0 where 8 (4 - 3 w) = 3 (1 + 8 w).
    double weight = -1;
    Estimate fused;
    REQUIRE(covariance_intersection(diagonal(1, 4), diagonal(9, 1), Criterion::determinant, weight, fused));
    CHECK(weight == Approx(29.0 / 48).epsilon(1e-12));
}

TEST_CASE("Covariance intersection's weight is better than any of a fine grid", "[fusion]") {
    std::mt19937 random(4);
    for (int trial = 0; trial < 20; ++trial) {
        Estimate two[2];
        for (Estimate& one : two) {
            const Eigen::MatrixXd root = random_square(random, 4);
            one = {Eigen::MatrixXd::Zero(4, 1),
                   Eigen::MatrixXd(root * root.transpose()) + 0.1 * Eigen::MatrixXd::Identity(4, 4)};
        }
        for (const Criterion criterion : {Criterion::determinant, Criterion::trace}) {
            double weight = -1;
            Estimate best, other;
            REQUIRE(covariance_intersection(two[0], two[1], criterion, weight, best));
            const double least = score(best, criterion);
            for (int k = 0; k <= 200; ++k) {
                const double weights[] = {k / 200.0, 1 - k / 200.0};
                REQUIRE(covariance_intersection(two, weights, 2, other));
                REQUIRE(least <= score(other, criterion) + 1e-9);
            }
        }
    }
}

TEST_CASE("Covariance intersection is consistent whatever the correlation of the errors", "[fusion]") {
    std::mt19937 random(8);
    for (int trial = 0; trial < 100; ++trial) {
        // A joint covariance of two errors with any cross-correlation.
        const Eigen::MatrixXd root = random_square(random, 6), joint = root * root.transpose();
        const Estimate both[] = {{Eigen::MatrixXd::Zero(3, 1), joint.topLeftCorner(3, 3)},
                                 {Eigen::MatrixXd::Zero(3, 1), joint.bottomRightCorner(3, 3)}};
        const double weight = 0.1 + 0.08 * (trial % 11), weights[] = {weight, 1 - weight};
        Estimate fused;
        REQUIRE(covariance_intersection(both, weights, 2, fused));
        // What the fused error really has: gains K_i = P w_i P_i^-1, found column by column from means that are unit vectors.
        Eigen::MatrixXd gains(3, 6);
        for (int column = 0; column < 6; ++column) {
            Estimate unit[] = {both[0], both[1]};
            unit[column / 3].mean(column % 3, 0) = 1;
            Estimate moved;
            REQUIRE(covariance_intersection(unit, weights, 2, moved));
            gains.col(column) = moved.mean;
        }
        pelorus::small::Bounded<3, 3> excess = Eigen::MatrixXd(fused.covariance) - gains * joint * gains.transpose();
        pelorus::small::Bounded<3, 1> values(3, 1);
        pelorus::small::Bounded<3, 3> vectors(3, 3);
        REQUIRE(pelorus::small::symmetric_eigen(excess, values, vectors));
        CHECK(values(0, 0) > -1e-9 * Eigen::MatrixXd(fused.covariance).trace());
    }
}

TEST_CASE("Covariance intersection refuses a covariance that is none", "[fusion]") {
    double weight = 0;
    Estimate fused;
    CHECK_FALSE(covariance_intersection(diagonal(1, 1), diagonal(1, -1), Criterion::trace, weight, fused));
    const Estimate both[] = {diagonal(1, 1), diagonal(0, 1)};
    const double weights[] = {0.5, 0.5}, first[] = {1, 0};
    CHECK_FALSE(covariance_intersection(both, weights, 2, fused));
    CHECK(covariance_intersection(both, first, 2, fused));
}
