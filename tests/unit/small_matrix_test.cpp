// The small-matrix loops against Eigen's dynamic matrices, for fixed and for bounded run-time sizes.
#include <pelorus/small_matrix.hpp>

#include <limits>
#include <random>

#include <catch2/catch.hpp>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace {

namespace small = pelorus::small;
using Eigen::MatrixXd;
using Eigen::VectorXd;
template <int R, int C> using Fixed = Eigen::Matrix<double, R, C>;
using Bounded = small::Bounded<12, 12>;

MatrixXd random_matrix(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
    std::mt19937_64 engine(seed);
    MatrixXd out(rows, cols);
    for (Eigen::Index k = 0; k < out.size(); ++k)
        out.data()[k] = 2.0 * static_cast<double>(engine() >> 11) * 0x1p-53 - 1.0;
    return out;
}

MatrixXd random_covariance(Eigen::Index n, unsigned seed) {
    const MatrixXd a = random_matrix(n, n, seed);
    return a * a.transpose() + 0.1 * MatrixXd::Identity(n, n);
}

/// Largest difference, relative to the largest element.
double difference(const MatrixXd& a, const MatrixXd& b) {
    if (a.rows() != b.rows() || a.cols() != b.cols()) return std::numeric_limits<double>::infinity();
    return (a - b).cwiseAbs().maxCoeff() / std::max(1e-300, b.cwiseAbs().maxCoeff());
}

template <class M> bool symmetric(const M& a) {
    for (Eigen::Index j = 0; j < a.cols(); ++j)
        for (Eigen::Index i = 0; i < j; ++i)
            if (a(i, j) != a(j, i)) return false;
    return true;
}

/// All products and updates for one pair of sizes, in types N x N, M x N, N x M, M x M.
template <class NN, class MN, class NM, class MM> void check_products(Eigen::Index n, Eigen::Index m, unsigned seed) {
    const MatrixXd p = random_covariance(n, seed), r = random_covariance(m, seed + 1);
    const MatrixXd h = random_matrix(m, n, seed + 2), k = random_matrix(n, m, seed + 3),
                   f = random_matrix(n, n, seed + 4);
    const NN small_p = p, small_f = f;
    const MN small_h = h;
    const NM small_k = k;
    const MM small_r = r;
    MN mn(m, n);
    NM nm(n, m);
    NN nn(n, n);
    MM mm(m, m);

    small::multiply(small_h, small_p, mn);
    CHECK(difference(mn, h * p) < 1e-15);
    small::multiply_transposed(small_p, small_h, nm);
    CHECK(difference(nm, p * h.transpose()) < 1e-15);
    small::symmetric_product(small_f, small_p, nn);
    CHECK(difference(nn, f * p * f.transpose()) < 3e-15);
    CHECK(symmetric(nn));
    small::symmetric_product(small_h, small_p, mm);
    CHECK(difference(mm, h * p * h.transpose()) < 3e-15);
    small::gram(small_k, nn);
    CHECK(difference(nn, k * k.transpose()) < 1e-15);
    small::add_gram(small_f, nn);
    CHECK(difference(nn, k * k.transpose() + f * f.transpose()) < 1e-15);
    CHECK(symmetric(nn));
    NN l(n, n);
    MM r_half(m, m);
    REQUIRE(small::cholesky(small_p, l));
    REQUIRE(small::cholesky(small_r, r_half));
    small::multiply(small_h, l, mn);
    small::joseph_update(l, mn, r_half, small_k, nn);
    const MatrixXd rest = MatrixXd::Identity(n, n) - k * h;
    CHECK(difference(nn, rest * p * rest.transpose() + k * r * k.transpose()) < 1e-14);
    CHECK(symmetric(nn));
}

template <class NN, class N1> void check_factorisations(Eigen::Index n, unsigned seed) {
    const MatrixXd a = random_covariance(n, seed);
    const MatrixXd b = random_matrix(n, n, seed + 1);
    const VectorXd e = random_matrix(n, 1, seed + 2);
    const NN small_a = a;
    const N1 small_e = e;
    const Eigen::LLT<MatrixXd> reference(a);

    NN l(n, n);
    REQUIRE(small::cholesky(small_a, l));
    CHECK(difference(l, MatrixXd(reference.matrixL())) < 1e-13);
    NN again = small_a;
    REQUIRE(small::cholesky(again, again));
    CHECK(difference(again, l) == 0.0);
    REQUIRE(small::cholesky_semidefinite(small_a, again));
    CHECK(difference(again, l) == 0.0);

    NN x = b;
    small::cholesky_solve(l, x);
    CHECK(difference(a * MatrixXd(x), b) < 1e-12);
    const double log_determinant = std::log(a.determinant());
    CHECK(small::log_determinant(l) == Approx(log_determinant).epsilon(1e-12).margin(1e-12));
    const double squared = e.dot(reference.solve(e));
    CHECK(small::inverse_quadratic(l, small_e) == Approx(squared).epsilon(1e-12));
    const double log_normal = -0.5 * (static_cast<double>(n) * std::log(2.0 * M_PI) + log_determinant + squared);
    CHECK(small::log_normal(l, small_e) == Approx(log_normal).epsilon(1e-12));

    NN values_and_vectors(n, n), root(n, n), inverse_root(n, n);
    N1 values(n, 1);
    REQUIRE(small::symmetric_eigen(small_a, values, values_and_vectors));
    const MatrixXd v = values_and_vectors, d = VectorXd(values).asDiagonal();
    CHECK(difference(values, Eigen::SelfAdjointEigenSolver<MatrixXd>(a).eigenvalues()) < 1e-13);
    CHECK(difference(v * d * v.transpose(), a) < 1e-14);
    CHECK(difference(v.transpose() * v, MatrixXd::Identity(n, n)) < 1e-14);
    REQUIRE(small::square_root(small_a, root));
    REQUIRE(small::inverse_square_root(small_a, inverse_root));
    CHECK(symmetric(root));
    CHECK(difference(MatrixXd(root) * MatrixXd(root), a) < 1e-14);
    CHECK(difference(MatrixXd(inverse_root) * MatrixXd(root), MatrixXd::Identity(n, n)) < 1e-13);
}

}  // namespace

TEST_CASE("small products of fixed size agree with Eigen", "[small_matrix]") {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        check_products<Fixed<4, 4>, Fixed<2, 4>, Fixed<4, 2>, Fixed<2, 2>>(4, 2, 100 * seed);
        check_products<Fixed<9, 9>, Fixed<3, 9>, Fixed<9, 3>, Fixed<3, 3>>(9, 3, 100 * seed);
    }
}

TEST_CASE("small products of run-time size agree with Eigen", "[small_matrix]") {
    for (Eigen::Index n = 1; n <= 12; ++n)
        for (Eigen::Index m = 1; m <= std::min<Eigen::Index>(n, 6); ++m)
            check_products<Bounded, Bounded, Bounded, Bounded>(n, m, static_cast<unsigned>(20 * n + m));
}

TEST_CASE("small factorisations, roots and spectra agree with Eigen", "[small_matrix]") {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        check_factorisations<Fixed<2, 2>, Fixed<2, 1>>(2, seed);
        check_factorisations<Fixed<3, 3>, Fixed<3, 1>>(3, 10 * seed);
    }
    for (Eigen::Index n = 1; n <= 12; ++n)
        check_factorisations<Bounded, small::Bounded<12, 1>>(n, static_cast<unsigned>(1000 + n));
}

TEST_CASE("rank-one updates and symmetrising leave a symmetric matrix", "[small_matrix]") {
    Fixed<4, 4> a = random_matrix(4, 4, 7);
    const MatrixXd before = a;
    small::symmetrise(a);
    CHECK(symmetric(a));
    CHECK(difference(a, 0.5 * (before + before.transpose())) < 1e-15);
    const Fixed<4, 1> x = random_matrix(4, 1, 8);
    const MatrixXd expected = MatrixXd(a) + 0.3 * MatrixXd(x) * MatrixXd(x).transpose();
    small::add_outer(0.3, x, a);
    CHECK(symmetric(a));
    CHECK(difference(a, expected) < 1e-15);
}

TEST_CASE("Householder reflections from the right keep W W' and leave a triangle", "[small_matrix]") {
    for (Eigen::Index rows = 1; rows <= 8; ++rows) {
        const MatrixXd w = random_matrix(rows, 12, static_cast<unsigned>(rows));
        for (Eigen::Index count = 1; count <= rows; ++count) {
            Bounded reflected = w;
            small::triangularise_rows(reflected, count);
            CHECK(difference(MatrixXd(reflected) * MatrixXd(reflected).transpose(), w * w.transpose()) < 2e-15);
            for (Eigen::Index i = 0; i < count; ++i) {
                CHECK(reflected(i, i) >= 0.0);
                for (Eigen::Index j = i + 1; j < 12; ++j) CHECK(reflected(i, j) == 0.0);
            }
        }
    }
    Fixed<2, 3> already;
    already << -2.0, 0.0, 0.0, 3.0, 0.0, 0.0;
    small::triangularise_rows(already, 2);
    CHECK(already(0, 0) == 2.0);
    CHECK(already(1, 0) == -3.0);
}

TEST_CASE("Cholesky refuses what is not positive definite or not finite", "[small_matrix]") {
    Fixed<2, 2> a, l;
    a << 1.0, 2.0, 2.0, 1.0;
    CHECK_FALSE(small::cholesky(a, l));
    CHECK_FALSE(small::cholesky_semidefinite(a, l));
    a << 1.0, 1.0, 1.0, 1.0;
    CHECK_FALSE(small::cholesky(a, l));
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        a << bad, 0.0, 0.0, 1.0;
        CHECK_FALSE(small::cholesky(a, l));
        CHECK_FALSE(small::cholesky_semidefinite(a, l));
        a << 1.0, 0.0, bad, 1.0;
        CHECK_FALSE(small::cholesky(a, l));
        CHECK_FALSE(small::cholesky_semidefinite(a, l));
        Fixed<2, 1> values;
        CHECK_FALSE(small::symmetric_eigen(a, values, l));
        CHECK_FALSE(small::square_root(a, l));
    }
}

TEST_CASE("a semidefinite Cholesky accepts singular covariances and what rounding leaves of one", "[small_matrix]") {
    Fixed<3, 3> a = Fixed<3, 3>::Zero(), l, back;
    a.diagonal() << 4.0, 0.0, 9.0;
    REQUIRE(small::cholesky_semidefinite(a, l));
    small::gram(l, back);
    CHECK(difference(back, a) == 0.0);

    // A variance of 1 added to one of 1e24 is lost: the correlation is 1, and rounding may even exceed it.
    for (const double excess : {0.0, 1e8, 1e12}) {
        a << 1e24, 1e24, 0.0, 1e24, 1e24 - excess, 0.0, 0.0, 0.0, 1.0;
        CHECK_FALSE(small::cholesky(a, l));
        REQUIRE(small::cholesky_semidefinite(a, l));
        CHECK(l(1, 1) > 0.0);
        small::gram(l, back);
        CHECK(difference(back, a) < 1e-11);
    }
    a << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0;
    CHECK_FALSE(small::cholesky_semidefinite(a, l));
}

TEST_CASE("roots of graded and of singular matrices", "[small_matrix]") {
    Fixed<2, 2> a, root;
    // Eigenvalues 2e8 and 5e-9: a bisected difference would lose the small one altogether.
    a << 1e8 + 1e-8, 1e8 - 1e-8, 1e8 - 1e-8, 1e8 + 1e-8;
    Fixed<2, 1> values;
    Fixed<2, 2> vectors;
    REQUIRE(small::symmetric_eigen(a, values, vectors));
    CHECK(values(1) == Approx(2e8).epsilon(1e-15));
    a << 25.0, 0.0, 0.0, 0.0;
    REQUIRE(small::square_root(a, root));
    CHECK(root(0, 0) == 5.0);
    CHECK(root(1, 1) == 0.0);
    CHECK_FALSE(small::inverse_square_root(a, root));
    a << 25.0, 0.0, 0.0, -1.0;
    CHECK_FALSE(small::square_root(a, root));
    CHECK_FALSE(small::inverse_square_root(a, root));
    Fixed<3, 3> graded = Fixed<3, 3>::Zero(), graded_root;
    graded.diagonal() << 1e24, 1.0, 1e-24;
    graded(0, 1) = graded(1, 0) = 1e5;
    REQUIRE(small::inverse_square_root(graded, graded_root));
    CHECK(graded_root(2, 2) == Approx(1e12).epsilon(1e-12));
}
