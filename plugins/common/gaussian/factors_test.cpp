// Factors of covariances against the covariances themselves.
#include "factors.hpp"

#include <random>

#include <catch2/catch.hpp>
#include <Eigen/Core>

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
