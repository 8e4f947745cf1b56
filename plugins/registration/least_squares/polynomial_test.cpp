#include "polynomial.hpp"

#include <catch2/catch.hpp>

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Times of n samples a period apart, the last at 0.
VectorXd even(Index n, double period) {
    VectorXd times(n);
    for (Index i = 0; i < n; ++i) times(i) = -period * static_cast<double>(n - 1 - i);
    return times;
}

std::vector<const MatrixXd*> pointers(const std::vector<MatrixXd>& matrices) {
    std::vector<const MatrixXd*> out;
    for (const MatrixXd& each : matrices) out.push_back(&each);
    return out;
}

}  // namespace

TEST_CASE("least squares: on even times the weights of a line are the published ones", "[registration]") {
    for (const Index count : {1, 2, 3, 10, 40}) {
        const VectorXd w = least_squares::weights(even(count, 0.05), 1);
        const auto n = static_cast<double>(count);
        const double c1 = -2 / n, c2 = 6 / (n * (n + 1));
        double moment = 0;
        for (Index i = 0; i < count; ++i) {
            CHECK(std::abs(w(i) - (c1 + c2 * static_cast<double>(i + 1))) < 1e-12);
            moment += w(i) * static_cast<double>(i + 1 - count);
        }
        CHECK(std::abs(w.sum() - 1) < 1e-12);
        if (count > 1) CHECK(std::abs(moment) < 1e-12);  // one sample has no slope
        CHECK(std::abs(w.squaredNorm() - 2 * (2 * n - 1) / (n * (n + 1))) < 1e-12);
    }
}

TEST_CASE("least squares: weights tell any polynomial of their order exactly, on any times", "[registration]") {
    VectorXd times(7);
    times << -2.9, -2.1, -2.05, -1.2, -0.7, -0.11, 0.4;
    for (const int order : {1, 2}) {
        const VectorXd w = least_squares::weights(times, order);
        CHECK(std::abs(w.sum() - 1) < 1e-12);
        CHECK(std::abs(w.dot(times)) < 1e-12);
        if (order == 2) CHECK(std::abs(w.dot(times.cwiseAbs2())) < 1e-12);
    }
}

TEST_CASE("least squares: the end of a parabola has the variance of the literature", "[registration]") {
    // The variance of the last value of a parabola on n even times: 3 (3 n^2 - 3 n + 2)/(n (n + 1) (n + 2)) sigma^2
    // (Brookner, Tracking and Kalman Filtering Made Easy, 1998, the expanding-memory filter of degree 2).
    for (const Index count : {3, 4, 10, 40}) {
        const auto n = static_cast<double>(count);
        const VectorXd w = least_squares::weights(even(count, 0.05), 2);
        CHECK(std::abs(w.squaredNorm() - 3 * (3 * n * n - 3 * n + 2) / (n * (n + 1) * (n + 2))) < 1e-12);
    }
}

TEST_CASE("least squares: too few samples lower the order", "[registration]") {
    CHECK(least_squares::weights(even(1, 1), 2) == VectorXd::Ones(1));
    CHECK((least_squares::weights(even(2, 1), 2) - least_squares::weights(even(2, 1), 1)).norm() < 1e-15);
}

TEST_CASE("least squares: samples of other covariances count by them, as the textbook's weighted line",
          "[registration]") {
    // Bevington, Data Reduction and Error Analysis, 6.12 and 6.23, at x = 0: a = (S_xx S_y - S_x S_xy)/D, var a = S_xx/D.
    VectorXd times(5), y(5), variances(5);
    times << -1.0, -0.8, -0.5, -0.45, -0.1;
    y << 3.0, 2.2, 2.9, 1.0, 0.5;
    variances << 1.0, 4.0, 0.25, 9.0, 2.0;
    double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    std::vector<MatrixXd> covariances;
    for (Index i = 0; i < 5; ++i) {
        const double w = 1 / variances(i);
        s += w, sx += w * times(i), sy += w * y(i), sxx += w * times(i) * times(i), sxy += w * times(i) * y(i);
        // A second component with ten thousand times the variance and half of full correlation.
        MatrixXd r(2, 2);
        r << variances(i), 50 * variances(i), 50 * variances(i), 1e4 * variances(i);
        covariances.push_back(r);
    }
    MatrixXd values(2, 5);
    values << y.transpose(), 100 * y.transpose();
    const auto told = least_squares::fit(times, values, pointers(covariances), 1);
    const double d = s * sxx - sx * sx;
    CHECK(told.value(0) == Approx((sxx * sy - sx * sxy) / d).epsilon(1e-12));
    CHECK(told.value(1) == Approx(100 * (sxx * sy - sx * sxy) / d).epsilon(1e-12));
    CHECK(told.covariance(0, 0) == Approx(sxx / d).epsilon(1e-12));
    CHECK(told.covariance(1, 1) == Approx(1e4 * sxx / d).epsilon(1e-12));
    CHECK(told.covariance(0, 1) == Approx(50 * sxx / d).epsilon(1e-12));
}

TEST_CASE("least squares: both ways agree where covariances hardly differ", "[registration]") {
    for (const int order : {1, 2}) {
        const VectorXd times = even(40, 0.05);
        const MatrixXd values = MatrixXd::Random(3, 40), same = Eigen::Vector3d(25, 1e-10, 1e-10).asDiagonal();
        std::vector<MatrixXd> covariances(40, same);
        const auto plain = least_squares::fit(times, values, pointers(covariances), order);
        covariances[7] *= 1 + 1e-13;
        const auto weighted = least_squares::fit(times, values, pointers(covariances), order);
        CHECK((plain.value - weighted.value).norm() < 1e-10);
        CHECK((plain.covariance - weighted.covariance).norm() < 1e-10 * plain.covariance.norm());
    }
}

TEST_CASE("least squares: covariances without an inverse leave the samples alike", "[registration]") {
    const VectorXd times = even(4, 1), w = least_squares::weights(times, 1);
    std::vector<MatrixXd> covariances(4, MatrixXd::Zero(1, 1));
    covariances[3](0, 0) = 4;
    const MatrixXd values = MatrixXd::Random(1, 4);
    const auto told = least_squares::fit(times, values, pointers(covariances), 1);
    CHECK(told.value(0) == Approx(values.row(0).dot(w)));
    CHECK(told.covariance(0, 0) == Approx(4 * w(3) * w(3)));
}
