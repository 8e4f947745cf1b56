// The algebra over lanes gives what the algebra of single matrices gives, the same bytes for every instruction set and for any
// neighbours.
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include <catch2/catch.hpp>
#include <pelorus/small_matrix.hpp>

#include "instruction_set.hpp"
#include "lanes_under_test.hpp"

using Eigen::MatrixXd;
using Eigen::VectorXd;
using lanes_under_test::Algebra;
using Numbers = std::vector<double>;

namespace {

constexpr double eps = 2.220446049250313e-16;

/// Those that this processor can run, the baseline first.
std::vector<const Algebra*> supported() {
    std::vector<const Algebra*> found{&lanes_under_test::baseline::algebra};
#if defined(__x86_64__)
    if (lanes::is_supported(lanes::InstructionSet::avx2)) found.push_back(&lanes_under_test::avx2::algebra);
    if (lanes::is_supported(lanes::InstructionSet::avx512)) found.push_back(&lanes_under_test::avx512::algebra);
#endif
    return found;
}

Numbers drawn(std::size_t count, unsigned seed) {
    std::mt19937_64 engine(seed);
    Numbers out(count);
    for (double& x : out) x = 2.0 * static_cast<double>(engine() >> 11) * 0x1p-53 - 1.0;
    return out;
}

bool same_bytes(const Numbers& a, const Numbers& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

Eigen::Map<const MatrixXd> item(const Numbers& numbers, int i, int rows, int columns) {
    return {numbers.data() + i * rows * columns, rows, columns};
}

/// Eight covariances: of full rank, of all scales, singular, of no variance at all in one component.
Numbers covariances(int n) {
    Numbers out;
    for (int i = 0; i < 8; ++i) {
        const Numbers numbers =
            drawn(static_cast<std::size_t>(n * n), 10U * static_cast<unsigned>(n) + static_cast<unsigned>(i));
        MatrixXd factor = item(numbers, 0, n, n);
        if (i == 1) factor.row(0) *= 1e12;
        if (i == 2 && n > 1) factor.row(n - 1) = factor.row(0);
        if (i == 3) factor.row(n / 2).setZero();
        if (i == 4) factor *= 1e-12;
        const MatrixXd p = factor * factor.transpose();
        out.insert(out.end(), p.data(), p.data() + n * n);
    }
    return out;
}

/// Runs `call(algebra, items, first item)` for eight items, as many at once as there are lanes, and again one by one.
template <class Call> void in_lanes(const Algebra& algebra, bool one_by_one, Call call) {
    const int step = one_by_one ? 1 : algebra.width;
    for (int first = 0; first < 8; first += step) call(step, first);
}

/// What `call(algebra, items, first, out)` makes of eight items of `size` numbers each: the same bytes for all.
template <class Call> Numbers agreed(int size, Call call) {
    Numbers expected;
    for (const Algebra* const algebra : supported()) {
        for (const bool one_by_one : {false, true}) {
            Numbers out(static_cast<std::size_t>(8 * size), 0.0);
            in_lanes(*algebra, one_by_one,
                     [&](int items, int first) { call(*algebra, items, first, out.data() + first * size); });
            if (expected.empty()) expected = out;
            CAPTURE(algebra->width, one_by_one);
            CHECK(same_bytes(out, expected));
        }
    }
    return expected;
}

}  // namespace

TEST_CASE("items come back from the lanes as they went in, but for those left out", "[lanes]") {
    for (const Algebra* const algebra : supported()) {
        for (const int size : {1, 2, 3, 7, 8, 9, 16, 42, 90}) {
            for (int items = 1; items <= algebra->width; ++items) {
                CAPTURE(algebra->width, size, items);
                const Numbers from = drawn(static_cast<std::size_t>(size * items), 3);
                for (const bool complete : {true, false}) {
                    bool skip[8] = {};
                    skip[items - 1] = !complete;
                    Numbers to(from.size(), 7.0), expected = from;
                    if (!complete) std::fill(expected.end() - size, expected.end(), 7.0);
                    algebra->copy(size, items, from.data(), skip, to.data());
                    REQUIRE(to == expected);
                }
            }
        }
    }
}

TEST_CASE("the factor of a covariance is the one that single matrices have, singular ones included", "[lanes]") {
    for (const int n : {1, 2, 3, 4, 6, 9, 12}) {
        CAPTURE(n);
        const Numbers p = covariances(n);
        const Numbers l = agreed(n * n, [&](const Algebra& algebra, int items, int first, double* out) {
            bool failed[8];
            algebra.cholesky(n, items, p.data() + first * n * n, out, failed);
            for (int i = 0; i < items; ++i) CHECK(!failed[i]);
        });
        for (int i = 0; i < 8; ++i) {
            CAPTURE(i);
            pelorus::small::Bounded<12, 12> single(n, n);
            REQUIRE(pelorus::small::cholesky_semidefinite(pelorus::small::Bounded<12, 12>(item(p, i, n, n)), single));
            const MatrixXd lower = item(l, i, n, n).triangularView<Eigen::Lower>();
            CHECK((lower - single).cwiseAbs().maxCoeff() <= 1e-9 * (1e-300 + single.cwiseAbs().maxCoeff()));
            const MatrixXd error = lower * lower.transpose() - item(p, i, n, n);
            const VectorXd deviation = item(p, i, n, n).diagonal().cwiseSqrt();
            for (int c = 0; c < n; ++c)
                for (int r = 0; r < n; ++r) CHECK(std::fabs(error(r, c)) <= 4 * n * eps * deviation(r) * deviation(c));
        }
    }
}

TEST_CASE("an indefinite or infinite matrix fails in its lane alone", "[lanes]") {
    const double infinity = std::numeric_limits<double>::infinity();
    for (const Algebra* const algebra : supported()) {
        for (const int n : {3, 6, 7}) {
            Numbers p = covariances(n), l(p.size());
            p[0] = -1e-3 * p[0];                                            // item 0
            p[static_cast<std::size_t>(2 * n * n - 1)] = std::nan("");      // item 1, if it is in a lane
            p[static_cast<std::size_t>(3 * n * n - n * n + 1)] = infinity;  // item 2: below the diagonal
            p[static_cast<std::size_t>(4 * n * n - n * n)] = infinity;      // item 3: on it
            bool failed[8];
            algebra->cholesky(n, algebra->width, p.data(), l.data(), failed);
            for (int i = 0; i < algebra->width; ++i) {
                CAPTURE(algebra->width, n, i);
                CHECK(failed[i] == (i < 4));
            }
        }
    }
}

TEST_CASE("a triangle has the square of what it was made from and a diagonal that is not negative", "[lanes]") {
    for (const auto& [rows, columns] :
         {std::pair(1, 1), std::pair(2, 4), std::pair(3, 6), std::pair(3, 12), std::pair(6, 18)}) {
        CAPTURE(rows, columns);
        const int size = rows * columns;
        Numbers w = drawn(static_cast<std::size_t>(8 * size), 11);
        // One that has its form already, but for signs; one of nothing.
        for (int c = 0; c < columns; ++c) {
            for (int r = 0; r < rows; ++r) {
                if (c > r) w[static_cast<std::size_t>(3 * size + c * rows + r)] = 0.0;
                w[static_cast<std::size_t>(5 * size + c * rows + r)] = 0.0;
            }
        }
        const Numbers t =
            agreed(size, [&, r = rows, c = columns](const Algebra& algebra, int items, int first, double* out) {
                algebra.triangularise(r, c, items, w.data() + first * size, out);
            });
        for (int i = 0; i < 8; ++i) {
            const MatrixXd triangle = item(t, i, rows, columns).leftCols(rows).triangularView<Eigen::Lower>();
            const MatrixXd from = item(w, i, rows, columns);
            CHECK((triangle * triangle.transpose() - from * from.transpose()).cwiseAbs().maxCoeff() <
                  20 * columns * eps);
            CHECK(triangle.diagonal().minCoeff() >= 0.0);
        }
    }
}

TEST_CASE("systems are solved and densities are those of the textbook", "[lanes]") {
    for (const int n : {1, 2, 3, 6}) {
        CAPTURE(n);
        const Numbers e = drawn(static_cast<std::size_t>(8 * n), 17);
        Numbers l;
        for (int i = 0; i < 8; ++i) {
            const Numbers numbers = drawn(static_cast<std::size_t>(n * n), static_cast<unsigned>(100 + i));
            MatrixXd factor = item(numbers, 0, n, n).triangularView<Eigen::Lower>();
            factor.diagonal().array() = factor.diagonal().array().abs() + 1.0;
            l.insert(l.end(), factor.data(), factor.data() + n * n);
        }
        const Numbers x = agreed(n, [&](const Algebra& algebra, int items, int first, double* out) {
            std::copy_n(e.data() + first * n, items * n, out);
            algebra.solve(n, 1, items, l.data() + first * n * n, out);
        });
        const Numbers density = agreed(1, [&](const Algebra& algebra, int items, int first, double* out) {
            algebra.log_normal(n, items, l.data() + first * n * n, e.data() + first * n, out);
        });
        const Numbers squares = agreed(n * n, [&](const Algebra& algebra, int items, int first, double* out) {
            algebra.gram(n, n, items, l.data() + first * n * n, out);
        });
        for (int i = 0; i < 8; ++i) {
            const MatrixXd s = item(l, i, n, n) * item(l, i, n, n).transpose();
            CHECK((item(squares, i, n, n) - s).cwiseAbs().maxCoeff() < 1e-14 * s.cwiseAbs().maxCoeff());
            CHECK((s * item(x, i, n, 1) - item(e, i, n, 1)).cwiseAbs().maxCoeff() < 1e-13);
            const MatrixXd whitened = item(l, i, n, n).triangularView<Eigen::Lower>().solve(item(e, i, n, 1));
            const double logarithm = 2.0 * item(l, i, n, n).diagonal().array().log().sum();
            const double expected = -0.5 * (n * std::log(2.0 * std::acos(-1.0)) + logarithm + whitened.squaredNorm());
            CHECK(std::fabs(density[static_cast<std::size_t>(i)] - expected) < 1e-12 * std::fabs(expected) + 1e-13);
        }
    }
}

TEST_CASE("logarithms are off by less than one unit in the last place, at all sizes of numbers", "[lanes]") {
    std::mt19937_64 engine(23);
    Numbers x{1.0,
              2.0,
              0.5,
              4.9406564584124654e-324,
              2.2250738585072014e-308,
              1.7976931348623157e308,
              1.4142135623730951,
              std::nextafter(1.0, 2.0),
              std::nextafter(1.0, 0.0),
              1e-310,
              1e24,
              1e-24};
    while (x.size() < 8000) {
        const double fraction = 1.0 + static_cast<double>(engine() >> 11) * 0x1p-53;
        x.push_back(x.size() % 2 == 0 ? fraction : std::ldexp(fraction, static_cast<int>(engine() % 2000) - 1000));
    }
    Numbers first;
    for (const Algebra* const algebra : supported()) {
        Numbers out(x.size());
        for (std::size_t i = 0; i < x.size(); i += static_cast<std::size_t>(algebra->width))
            algebra->logarithm(algebra->width, x.data() + i, out.data() + i);
        if (first.empty()) first = out;
        CHECK(same_bytes(out, first));
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        const long double exact = std::log(static_cast<long double>(x[i]));
        const double unit = std::fabs(std::nextafter(first[i], 1e9) - first[i]);
        CAPTURE(x[i], first[i]);
        REQUIRE(std::fabs(static_cast<double>(first[i] - exact)) <= unit);
    }
}
