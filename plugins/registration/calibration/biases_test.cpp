#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include <Eigen/Cholesky>

#include "biases.hpp"

namespace {

using namespace calibration;
using Eigen::MatrixXd;
using Eigen::VectorXd;

BiasVector deviations(std::initializer_list<std::pair<int, double>> given) {
    BiasVector out = BiasVector::Zero();
    for (const auto& [bias, deviation] : given) out(bias) = deviation;
    return out;
}

/// Measurements d = H b + noise of three biases, and the answer by the book: every subset's evidence and regression.
struct Regression {
    std::vector<int> biases{roll, yaw, clock_offset};
    VectorXd prior = Eigen::Vector3d(1e-3, 2e-3, 0.02);
    MatrixXd h;
    VectorXd d, noise;

    explicit Regression(unsigned seed) : h(8, 3), d(8), noise(8) {
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal;
        for (int i = 0; i < 8; ++i) {
            h.row(i) << normal(random), normal(random), 0.05 * normal(random);
            noise(i) = 4e-6 * (1 + 0.1 * i);
            d(i) = h(i, 1) * 1.5e-3 + std::sqrt(noise(i)) * normal(random);
        }
    }
    Biases filtered(double presence) const {
        BiasVector sd = BiasVector::Zero();
        for (int k = 0; k < 3; ++k) sd(biases[static_cast<std::size_t>(k)]) = prior(k);
        Biases out(sd, presence);
        for (int i = 0; i < 8; ++i) {
            BiasSlope slope = BiasSlope::Zero(1, bias_count);
            for (int k = 0; k < 3; ++k) slope(0, biases[static_cast<std::size_t>(k)]) = h(i, k);
            VectorXd e(1);
            e << d(i) - (slope * out.mean())(0);
            out.update(e, slope, MatrixXd::Constant(1, 1, noise(i)));
        }
        return out;
    }
    struct Answer {
        Eigen::Vector3d value = Eigen::Vector3d::Zero(), presence = Eigen::Vector3d::Zero();
        Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    };
    Answer by_enumeration(double presence) const {
        Answer out;
        double total = 0;
        Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
        for (unsigned set = 0; set < 8; ++set) {
            Eigen::Matrix3d p = Eigen::Matrix3d::Zero();
            double weight = 1;
            for (int k = 0; k < 3; ++k) {
                const bool in = (set >> k & 1u) != 0;
                weight *= in ? presence : 1 - presence;
                if (in) p(k, k) = prior(k) * prior(k);
            }
            const MatrixXd s = h * p * h.transpose() + MatrixXd(noise.asDiagonal());
            const Eigen::LLT<MatrixXd> factor(s);
            weight *= std::exp(-0.5 * d.dot(factor.solve(d))) / MatrixXd(factor.matrixL()).diagonal().prod();
            const Eigen::Vector3d mean = p * h.transpose() * factor.solve(d);
            const Eigen::Matrix3d covariance = p - p * h.transpose() * factor.solve(h * p);
            total += weight;
            out.value += weight * mean;
            second += weight * (covariance + mean * mean.transpose());
            for (int k = 0; k < 3; ++k)
                if ((set >> k & 1u) != 0) out.presence(k) += weight;
        }
        out.value /= total;
        out.presence /= total;
        out.covariance = second / total - out.value * out.value.transpose();
        return out;
    }
};

}  // namespace

TEST_CASE("biases: the estimate is the mean over all regressions, weighted by their evidence", "[registration]") {
    const double presence = GENERATE(0.1, 0.5, 0.9);
    const unsigned seed = GENERATE(1u, 2u, 3u);
    const Regression regression(seed);
    const Biases biases = regression.filtered(presence);
    const Regression::Answer answer = regression.by_enumeration(presence);
    for (int k = 0; k < 3; ++k) {
        const int bias = regression.biases[static_cast<std::size_t>(k)];
        CHECK(biases.estimate().value(bias) == Approx(answer.value(k)).epsilon(1e-9));
        CHECK(biases.estimate().presence(bias) == Approx(answer.presence(k)).epsilon(1e-9));
        for (int l = 0; l < 3; ++l)
            CHECK(biases.estimate().covariance(bias, regression.biases[static_cast<std::size_t>(l)]) ==
                  Approx(answer.covariance(k, l)).epsilon(1e-8).margin(1e-20));
    }
    CHECK(biases.estimate().value(pitch) == 0);
}

TEST_CASE("biases: with certain presence the estimate is the filter's", "[registration]") {
    const Biases biases = Regression(4).filtered(1);
    CHECK(biases.estimate().value == biases.mean());
    CHECK(biases.estimate().covariance == biases.covariance());
    CHECK(biases.estimate().presence(yaw) == 1);
    CHECK(biases.estimate().presence(pitch) == 0);
}

TEST_CASE("biases: before anything is seen the estimate is nothing, with the prior's spread", "[registration]") {
    const Biases biases(deviations({{yaw, 1e-3}, {range_bias, 10}}), 0.25);
    CHECK(biases.estimate().value.isZero(0));
    CHECK(biases.estimate().presence(yaw) == Approx(0.25));
    CHECK(biases.estimate().covariance(range_bias, range_bias) == Approx(25));
    CHECK(biases.ratio(yaw) == 1);
    CHECK(biases.ratio(roll) == 1);
}

TEST_CASE("biases: one scalar follows the formula of the mean of many", "[registration]") {
    // n measurements of deviation s about a prior p: deviation p / sqrt(1 + n p^2 / s^2).
    Biases biases(deviations({{yaw, 1e-3}}), 1);
    BiasSlope slope = BiasSlope::Zero(1, bias_count);
    slope(0, yaw) = 1;
    for (int i = 0; i < 100; ++i)
        biases.update(VectorXd::Constant(1, 2e-3 - biases.mean()(yaw)), slope, MatrixXd::Constant(1, 1, 9e-6));
    CHECK(biases.ratio(yaw) == Approx(1 / std::sqrt(1 + 100 / 9.0)).epsilon(1e-12));
    CHECK(biases.mean()(yaw) == Approx(2e-3 * (100 / 9.0) / (1 + 100 / 9.0)).epsilon(1e-12));
}

TEST_CASE("biases: what is not seen is told as a direction", "[registration]") {
    // Only the difference of roll and yaw is seen, so half of their sum stays as it was.
    Biases biases(deviations({{roll, 1e-3}, {yaw, 1e-3}}), 0.5);
    BiasSlope slope = BiasSlope::Zero(1, bias_count);
    slope(0, roll) = 1;
    slope(0, yaw) = -1;
    for (int i = 0; i < 1000; ++i) biases.update(VectorXd::Zero(1), slope, MatrixXd::Constant(1, 1, 1e-8));
    const auto directions = biases.directions();
    REQUIRE(directions.size() == 2);
    CHECK(directions[0].ratio == Approx(1).epsilon(1e-9));
    CHECK(directions[0].share(roll) == Approx(std::sqrt(0.5)));
    CHECK(directions[0].share(yaw) == Approx(std::sqrt(0.5)));
    CHECK(directions[1].ratio < 0.01);
    CHECK(biases.ratio(yaw) == Approx(std::sqrt(0.5)).epsilon(1e-3));
}

TEST_CASE("biases: a noise that is nearly nothing leaves a covariance that is one", "[registration]") {
    Biases biases(deviations({{roll, 0.1}, {pitch, 0.1}, {yaw, 0.1}, {clock_offset, 1}}), 0.5);
    BiasSlope slope = BiasSlope::Zero(2, bias_count);
    for (int i = 0; i < 200; ++i) {
        slope.row(0) << std::cos(0.1 * i), std::sin(0.1 * i), 1, 0, 0, 0, 0, 1e-3;
        slope.row(1) << std::sin(0.1 * i), 1, std::cos(0.1 * i), 0, 0, 0, 0, -1e-3;
        biases.update(Eigen::Vector2d::Zero(), slope, 1e-20 * MatrixXd::Identity(2, 2));
    }
    const BiasMatrix p = biases.covariance();
    for (const int bias : biases.active()) CHECK(p(bias, bias) > 0);
    CHECK(p == p.transpose());
    CHECK(biases.estimate().value.allFinite());
    CHECK(biases.estimate().covariance.allFinite());
    CHECK_THROWS_AS(biases.update(Eigen::Vector2d(NAN, 0), slope, 1e-20 * MatrixXd::Identity(2, 2)),
                    pelorus::NumericError);
}
