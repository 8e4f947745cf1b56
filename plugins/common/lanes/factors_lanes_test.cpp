// Factors and angles over lanes against the textbook, each item as if it were alone.
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include <catch2/catch.hpp>
#include <Eigen/LU>
#include <pelorus/sensor.hpp>

#include "instruction_set.hpp"
#include "lanes_under_test.hpp"

using Eigen::MatrixXd;
using Eigen::VectorXd;
using lanes_under_test::Algebra;
using Numbers = std::vector<double>;

namespace {

constexpr int items = 8;

std::vector<const Algebra*> supported() {
    std::vector<const Algebra*> found{&lanes_under_test::baseline::algebra};
#if defined(__x86_64__)
    if (lanes::is_supported(lanes::InstructionSet::avx2)) found.push_back(&lanes_under_test::avx2::algebra);
    if (lanes::is_supported(lanes::InstructionSet::avx512)) found.push_back(&lanes_under_test::avx512::algebra);
#endif
    return found;
}

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

/// Eight items of equal size beside each other.
Numbers packed(const std::vector<MatrixXd>& matrices) {
    Numbers out;
    for (const MatrixXd& one : matrices) out.insert(out.end(), one.data(), one.data() + one.size());
    return out;
}
MatrixXd item(const Numbers& numbers, int i, std::int64_t rows, std::int64_t columns) {
    return Eigen::Map<const MatrixXd>(numbers.data() + i * rows * columns, rows, columns);
}

/// What `call(algebra, first, how many)` leaves in `numbers`: one answer for every instruction set, for items alone and together.
template <class Call> void agreed(std::vector<Numbers*> numbers, Call call) {
    std::vector<Numbers> given, expected;
    for (const Numbers* each : numbers) given.push_back(*each);
    for (const Algebra* const algebra : supported()) {
        for (const int step : {1, algebra->width}) {
            for (std::size_t k = 0; k < numbers.size(); ++k) *numbers[k] = given[k];
            for (int first = 0; first < items; first += step) call(*algebra, first, step);
            CAPTURE(algebra->width, step);
            for (std::size_t k = 0; k < numbers.size(); ++k) {
                if (expected.size() <= k) expected.push_back(*numbers[k]);
                CHECK(std::memcmp(numbers[k]->data(), expected[k].data(), expected[k].size() * sizeof(double)) == 0);
            }
        }
    }
}

}  // namespace

TEST_CASE("columns join factors over lanes as their squares join covariances", "[lanes]") {
    std::mt19937_64 engine(1);
    for (const int n : {1, 3, 5, 6, 9}) {
        for (const int columns : {0, 1, 6, 13}) {
            CAPTURE(n, columns);
            std::vector<MatrixXd> factors, more;
            for (int i = 0; i < items; ++i) {
                factors.push_back(random_factor(n, engine));
                more.push_back(random_matrix(n, columns, engine));
            }
            factors[1].setZero();
            more[2].setZero();
            if (columns > 0) more[3].row(0).setZero();
            Numbers l = packed(factors), c = packed(more);
            c.push_back(0.0);  // so that there is something to point to
            agreed({&l}, [&](const Algebra& algebra, int first, int some) {
                algebra.append(n, columns, some, l.data() + first * n * n, c.data() + first * n * columns);
            });
            for (int i = 0; i < items; ++i) {
                const MatrixXd expected =
                                   factors[static_cast<std::size_t>(i)] *
                                       factors[static_cast<std::size_t>(i)].transpose() +
                                   more[static_cast<std::size_t>(i)] * more[static_cast<std::size_t>(i)].transpose(),
                               got = item(l, i, n, n);
                CAPTURE(i);
                CHECK(is_factor(got));
                CHECK((got * got.transpose() - expected).norm() <= 1e-13 * expected.norm());
            }
        }
    }
}

TEST_CASE("columns that are not numbers do not vanish in a factor over lanes", "[lanes]") {
    Numbers l, c(4 * items, 0.0);
    for (int i = 0; i < items; ++i) {
        const MatrixXd one = MatrixXd::Identity(4, 4);
        l.insert(l.end(), one.data(), one.data() + 16);
    }
    c[3] = std::nan("");
    for (const Algebra* const algebra : supported()) {
        Numbers got = l;
        algebra->append(4, 1, algebra->width, got.data(), c.data());
        CHECK_FALSE(item(got, 0, 4, 4).allFinite());
        CHECK(item(got, 1, 4, 4).isIdentity(0.0));
    }
}

TEST_CASE("factors over lanes are reduced by what is taken from their covariances, as long as that is there",
          "[lanes]") {
    std::mt19937_64 engine(2);
    const MatrixXd one = random_factor(5, engine);
    const VectorXd direction = one * random_matrix(5, 1, engine).normalized();  // L L' - d d' is singular
    const double parts[items] = {0.0, 0.5, 0.999, 1.001, 0.25, std::nan(""), 0.9, 0.75};
    std::vector<MatrixXd> factors, directions;
    for (const double part : parts) {
        factors.push_back(one);
        directions.emplace_back(part * direction);
    }
    Numbers l = packed(factors);
    const Numbers u = packed(directions);
    agreed({&l}, [&](const Algebra& algebra, int first, int some) {
        bool failed[items];
        algebra.downdate(5, some, l.data() + first * 25, u.data() + first * 5, failed);
        for (int i = 0; i < some; ++i) CHECK(failed[i] == !(parts[first + i] < 1.0));
    });
    for (int i = 0; i < items; ++i) {
        if (!(parts[i] < 1.0)) continue;
        const MatrixXd got = item(l, i, 5, 5);
        const MatrixXd expected = one * one.transpose() - parts[i] * parts[i] * direction * direction.transpose();
        CHECK(is_factor(got));
        CHECK((got * got.transpose() - expected).norm() < 1e-12 * expected.norm());
    }
    // Where there is no spread, nothing can be taken.
    Numbers none(2 * 4, 0.0);
    bool failed[2];
    const double little[] = {0.0, 0.0, 0.0, 1e-9};
    lanes_under_test::baseline::algebra.downdate(2, 2, none.data(), little, failed);
    CHECK_FALSE(failed[0]);
    CHECK(failed[1]);
}

TEST_CASE("the array form of an update over lanes is the textbook's", "[lanes]") {
    struct Sizes {
        int n, m, seen;
    };
    for (const Sizes size : {Sizes{6, 3, 6}, {6, 3, 3}, {9, 2, 2}, {5, 4, 3}, {1, 1, 1}}) {
        const auto [n, m, seen] = size;
        CAPTURE(n, m, seen);
        std::mt19937_64 engine(3);
        std::vector<MatrixXd> factors, noises, slopes, jacobians;
        for (int i = 0; i < items; ++i) {
            factors.push_back(random_factor(n, engine));
            noises.push_back(random_factor(m, engine));
            jacobians.emplace_back(MatrixXd::Zero(m, n));
            jacobians.back().leftCols(seen) = random_matrix(m, seen, engine);
            slopes.emplace_back((jacobians.back() * factors.back()).leftCols(seen));
        }
        Numbers s = packed(factors), z = packed(noises), k(static_cast<std::size_t>(items * n * m));
        const Numbers g = packed(slopes);
        agreed({&s, &z, &k}, [&](const Algebra& algebra, int first, int some) {
            algebra.update(n, m, seen, some, s.data() + first * n * n, z.data() + first * m * m,
                           g.data() + first * m * seen, k.data() + first * n * m);
        });
        for (int i = 0; i < items; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const MatrixXd p = factors[at] * factors[at].transpose(), h = jacobians[at];
            const MatrixXd covariance = h * p * h.transpose() + noises[at] * noises[at].transpose();
            const MatrixXd gain = p * h.transpose() * covariance.inverse();
            const MatrixXd after = item(s, i, n, n), root = item(z, i, m, m);
            CHECK(is_factor(after));
            CHECK(is_factor(root));
            CHECK((root * root.transpose() - covariance).norm() < 1e-12 * covariance.norm());
            CHECK((item(k, i, n, m) - gain * root).norm() < 1e-11 * gain.norm() * root.norm());
            CHECK((after * after.transpose() - (p - gain * covariance * gain.transpose())).norm() < 1e-12 * p.norm());
        }
    }
}

TEST_CASE("reflections over lanes make of an update what the textbook does", "[lanes]") {
    struct Sizes {
        int n, m, seen;
    };
    for (const Sizes size : {Sizes{6, 3, 6}, {6, 3, 3}, {9, 2, 2}, {5, 4, 3}, {3, 3, 1}, {1, 1, 1}}) {
        const auto [n, m, seen] = size;
        CAPTURE(n, m, seen);
        std::mt19937_64 engine(4);
        std::vector<MatrixXd> factors, arrays;
        for (int i = 0; i < items; ++i) {
            factors.push_back(random_factor(n, engine));
            MatrixXd array(m, seen + m);
            array << random_matrix(m, seen, engine) * factors.back().topLeftCorner(seen, seen),
                random_factor(m, engine);
            arrays.push_back(array);
        }
        const Numbers s = packed(factors);
        Numbers w = packed(arrays), out(static_cast<std::size_t>(items * n * (seen + m)));
        agreed({&w, &out}, [&](const Algebra& algebra, int first, int some) {
            algebra.reflect(n, m, seen, some, s.data() + first * n * n, w.data() + first * m * (seen + m),
                            out.data() + first * n * (seen + m));
        });
        for (int i = 0; i < items; ++i) {
            const auto at = static_cast<std::size_t>(i);
            const MatrixXd g = arrays[at].leftCols(seen), before = factors[at].leftCols(seen);
            const MatrixXd covariance = arrays[at] * arrays[at].transpose(), cross = before * g.transpose();
            const MatrixXd root = item(w, i, m, seen + m).leftCols(m).triangularView<Eigen::Lower>();
            const MatrixXd columns = item(out, i, n, seen + m), after = columns.rightCols(seen);
            const MatrixXd expected = before * before.transpose() - cross * covariance.inverse() * cross.transpose();
            CHECK(root.diagonal().minCoeff() >= 0.0);
            CHECK((root * root.transpose() - covariance).norm() < 1e-12 * covariance.norm());
            CHECK((columns.leftCols(m) * root.transpose() - cross).norm() < 1e-12 * (1.0 + cross.norm()));
            CHECK((after * after.transpose() - expected).norm() < 1e-12 * (1.0 + before.squaredNorm()));
        }
    }
}

TEST_CASE("an update over lanes keeps 1 m beside 1e12 m, and takes measurements without noise", "[lanes]") {
    for (const Algebra* const algebra : supported()) {
        MatrixXd s = 1e12 * MatrixXd::Identity(4, 4), z = MatrixXd::Identity(2, 2), k(4, 2);
        s(2, 0) = s(3, 1) = 0.5e12;
        MatrixXd g = s.topLeftCorner(2, 2);
        algebra->update(4, 2, 2, 1, s.data(), z.data(), g.data(), k.data());
        CHECK(s(0, 0) == Approx(1.0));
        CHECK(s(2, 2) == Approx(1e12));
        s.setIdentity();
        z.setZero();
        g = s.topLeftCorner(2, 2);
        algebra->update(4, 2, 2, 1, s.data(), z.data(), g.data(), k.data());
        CHECK(MatrixXd(s.topLeftCorner(2, 2)).isZero(0.0));
        CHECK(MatrixXd(s.bottomRightCorner(2, 2)).isIdentity(0.0));
        CHECK(z.isIdentity(0.0));
    }
}

TEST_CASE("angles of vectors are off by less than one and a half units in the last place, in all directions",
          "[lanes]") {
    std::mt19937_64 engine(17);
    std::normal_distribution<double> normal;
    Numbers x, y;
    for (const double a : {0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, 1e-290, -3.0}) {
        for (const double b : {0.0, -0.0, 1.0, -1.0, 1e-300, 1e300, 1e-290, 0.4375}) {
            x.push_back(a);
            y.push_back(b);
        }
    }
    while (x.size() < 8000) {
        x.push_back(normal(engine));
        y.push_back(std::ldexp(normal(engine), static_cast<int>(engine() % 60) - 30));
    }
    Numbers out(x.size());
    for (const Algebra* const algebra : supported()) {
        Numbers got(x.size());
        for (std::size_t i = 0; i < x.size(); i += static_cast<std::size_t>(algebra->width))
            algebra->arc_tangent(algebra->width, y.data() + i, x.data() + i, got.data() + i);
        if (algebra == supported().front()) out = got;
        CHECK(std::memcmp(got.data(), out.data(), out.size() * sizeof(double)) == 0);
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
        const long double exact = std::atan2(static_cast<long double>(y[i]), static_cast<long double>(x[i]));
        const double unit = std::nextafter(std::fabs(out[i]), 10.0) - std::fabs(out[i]);
        CAPTURE(x[i], y[i], out[i]);
        REQUIRE(std::fabs(static_cast<double>(out[i] - exact)) <= 1.5 * unit);
        REQUIRE(std::signbit(out[i]) == std::signbit(y[i]));
    }
}

TEST_CASE("angles are wrapped over lanes to the bytes that single ones have", "[lanes]") {
    const double pi = std::acos(-1.0);
    const Numbers x{0.0, pi, -pi, 3.2, -3.2, 100.0, -1e6, 0.5};
    for (const Algebra* const algebra : supported()) {
        Numbers got(x.size());
        for (std::size_t i = 0; i < x.size(); i += static_cast<std::size_t>(algebra->width))
            algebra->wrap(algebra->width, x.data() + i, got.data() + i);
        for (std::size_t i = 0; i < x.size(); ++i) CHECK(got[i] == pelorus::wrap_angle(x[i]));
    }
}
