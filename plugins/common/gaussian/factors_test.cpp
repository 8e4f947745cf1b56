// Factors of covariances against the covariances themselves.
#include "factors.hpp"

#include <random>

#include <catch2/catch.hpp>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int bound = 12;

MatrixXd random_matrix(std::int64_t rows, std::int64_t cols, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    return MatrixXd::NullaryExpr(rows, cols, [&] { return normal(engine); });
}

MatrixXd random_factor(std::int64_t n, std::mt19937_64& engine) {
    MatrixXd l = random_matrix(n, n, engine).triangularView<Eigen::Lower>();
    l.diagonal() = l.diagonal().cwiseAbs().array() + 0.1;
    return l;
}

bool is_factor(const MatrixXd& l) {
    return l.diagonal().minCoeff() >= 0.0 && MatrixXd(l.triangularView<Eigen::StrictlyUpper>()).isZero(0.0);
}

template <int N> MatrixXd appended(MatrixXd l, MatrixXd c) {
    gaussian::append_columns<N, N == 0 ? bound : N>(static_cast<int>(l.rows()), l.data(), c.data(),
                                                    static_cast<int>(c.cols()));
    return l;
}

}  // namespace

TEST_CASE("columns join a factor as their squares join its covariance", "[gaussian]") {
    std::mt19937_64 engine(1);
    for (const int columns : {0, 1, 6, 40}) {
        CAPTURE(columns);
        const MatrixXd l = random_factor(6, engine), c = random_matrix(6, columns, engine);
        const MatrixXd expected = l * l.transpose() + c * c.transpose();
        for (const MatrixXd& got : {appended<0>(l, c), appended<6>(l, c)}) {
            CHECK(is_factor(got));
            CHECK((got * got.transpose() - expected).norm() < 1e-13 * expected.norm());
        }
    }
    const MatrixXd c = random_matrix(4, 2, engine);  // of rank 2, into nothing
    const MatrixXd got = appended<4>(MatrixXd::Zero(4, 4), c);
    CHECK(is_factor(got));
    CHECK((got * got.transpose() - c * c.transpose()).norm() < 1e-13);
}

TEST_CASE("columns that are not numbers do not vanish in a factor", "[gaussian]") {
    MatrixXd c = MatrixXd::Zero(4, 1);
    c(3, 0) = std::numeric_limits<double>::quiet_NaN();
    CHECK_FALSE(appended<4>(MatrixXd::Identity(4, 4), c).allFinite());
}

TEST_CASE("a factor is reduced by what is taken from its covariance, as long as that is there", "[gaussian]") {
    std::mt19937_64 engine(2);
    const MatrixXd l = random_factor(5, engine);
    const VectorXd direction = l * random_matrix(5, 1, engine).normalized();  // L L' - d d' is singular
    for (const double part : {0.0, 0.5, 0.999}) {
        MatrixXd got = l;
        VectorXd u = part * direction;
        const MatrixXd expected = l * l.transpose() - u * u.transpose();
        REQUIRE(gaussian::downdate<bound>(5, got.data(), u.data()));
        CHECK(is_factor(got));
        CHECK((got * got.transpose() - expected).norm() < 1e-12 * expected.norm());
    }
    MatrixXd got = l;
    VectorXd u = 1.001 * direction;
    CHECK_FALSE(gaussian::downdate<bound>(5, got.data(), u.data()));
    MatrixXd none = MatrixXd::Zero(2, 2);
    VectorXd little = VectorXd::Constant(2, 1e-9);
    CHECK_FALSE(gaussian::downdate<bound>(2, none.data(), little.data()));
    VectorXd nothing = VectorXd::Zero(2);
    CHECK(gaussian::downdate<bound>(2, none.data(), nothing.data()));
    VectorXd no_number = VectorXd::Constant(5, std::numeric_limits<double>::quiet_NaN());
    CHECK_FALSE(gaussian::downdate<bound>(5, got.data(), no_number.data()));
}

TEST_CASE("the array form of an update is the textbook's", "[gaussian]") {
    std::mt19937_64 engine(3);
    const MatrixXd s0 = random_factor(6, engine), n0 = random_factor(3, engine), h = random_matrix(3, 6, engine);
    const MatrixXd p = s0 * s0.transpose(), expected_z = h * p * h.transpose() + n0 * n0.transpose();
    const MatrixXd gain = p * h.transpose() * expected_z.inverse();
    const auto check = [&](auto update) {
        MatrixXd s = s0, z = n0, g = h * s0, k(6, 3);
        update(6, 3, s.data(), z.data(), g.data(), k.data());
        CHECK(is_factor(s));
        CHECK(is_factor(z));
        CHECK((z * z.transpose() - expected_z).norm() < 1e-12 * expected_z.norm());
        CHECK((k - gain * z).norm() < 1e-12 * k.norm());
        CHECK((s * s.transpose() - (p - gain * expected_z * gain.transpose())).norm() < 1e-12 * p.norm());
    };
    check(&gaussian::array_update<0, 0>);
    check(&gaussian::array_update<6, 3>);
}

TEST_CASE("an update by the array form keeps 1 m beside 1e12 m, and takes measurements without noise", "[gaussian]") {
    MatrixXd s = 1e12 * MatrixXd::Identity(4, 4), z = MatrixXd::Identity(2, 2), k(4, 2);
    s(2, 0) = s(3, 1) = 0.5e12;
    MatrixXd g = s.topRows(2);
    gaussian::array_update<4, 2>(4, 2, s.data(), z.data(), g.data(), k.data());
    CHECK(s(0, 0) == Approx(1.0));
    CHECK(s(2, 2) == Approx(1e12));
    s.setIdentity();
    z.setZero();
    g = s.topRows(2);
    gaussian::array_update<4, 2>(4, 2, s.data(), z.data(), g.data(), k.data());
    CHECK(MatrixXd(s.topLeftCorner(2, 2)).isZero(0.0));
    CHECK(MatrixXd(s.bottomRightCorner(2, 2)).isIdentity(0.0));
    CHECK(z.isIdentity(0.0));
}
