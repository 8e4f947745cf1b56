// The kernels over lanes: the textbook's numbers, and the same bytes for every instruction set, for blocks and single items.
#include "kalman_kernels.hpp"

#include <cstring>
#include <random>
#include <vector>

#include <catch2/catch.hpp>
#include <Eigen/Cholesky>

using namespace kalman;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Numbers = std::vector<double>;

namespace {

constexpr double untouched = 7.0;

/// A block of items of `size` numbers each.
struct Items {
    Items(int size, double value = untouched)
        : stride(size), numbers(static_cast<std::size_t>(size * block_items), value) {}
    ItemsIn in(int first = 0) const { return {numbers.data() + first * stride, stride}; }
    ItemsOut out(int first = 0) { return {numbers.data() + first * stride, stride}; }
    Eigen::Map<MatrixXd> matrix(int i, int offset, int rows, int columns) {
        return {numbers.data() + i * stride + offset, rows, columns};
    }
    int stride;
    Numbers numbers;
};

// Once for all sizes: Eigen's expressions compile slowly.
MatrixXd product(const MatrixXd& a, const MatrixXd& b) { return a * b; }
MatrixXd solved(const MatrixXd& a, const MatrixXd& b) { return a.ldlt().solve(b); }
double log_determinant(const MatrixXd& a) { return a.ldlt().vectorD().array().log().sum(); }
double largest(const MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }

class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    MatrixXd matrix(int rows, int columns) {
        MatrixXd out(rows, columns);
        for (int e = 0; e < rows * columns; ++e)
            out.data()[e] = 2.0 * static_cast<double>(engine_() >> 11) * 0x1p-53 - 1.0;
        return out;
    }
    MatrixXd covariance(int n) {
        const MatrixXd factor = matrix(n, n);
        return product(factor, factor.transpose()) + 0.1 * MatrixXd::Identity(n, n);
    }

private:
    std::mt19937_64 engine_;
};

struct Scene {
    Scene(int states, int measured, int leading)
        : n(states), m(measured), seen(leading), record(n + n * n), jacobian(m * n), noise(m * m), innovation(m) {
        Random random(static_cast<unsigned>(100 * n + 10 * m + seen));
        for (int i = 0; i < block_items; ++i) {
            record.matrix(i, 0, n, 1) = random.matrix(n, 1);
            record.matrix(i, n, n, n) = random.covariance(n);
            jacobian.matrix(i, 0, m, n).setZero();
            jacobian.matrix(i, 0, m, seen) = random.matrix(m, seen);
            noise.matrix(i, 0, m, m) = random.covariance(m);
            innovation.matrix(i, 0, m, 1) = random.matrix(m, 1);
        }
    }
    int n, m, seen;
    Items record, jacobian, noise, innovation;
};

/// All that an update, a projection or a prediction tells of a block.
struct Told {
    Told(int n, int m) : record(n + n * n), likelihood(1), innovation(m * m), projected(m * m), cross(n * m) {}
    bool operator==(const Told& other) const {
        const auto same = [](const Items& a, const Items& b) {
            return std::memcmp(a.numbers.data(), b.numbers.data(), a.numbers.size() * sizeof(double)) == 0;
        };
        return outcome == other.outcome && same(record, other.record) && same(likelihood, other.likelihood) &&
               same(innovation, other.innovation) && same(projected, other.projected) && same(cross, other.cross);
    }
    Items record, likelihood, innovation, projected, cross;
    std::array<Outcome, block_items> outcome{};
};

/// What `work(kernels, first, items, told)` makes of a block, as a whole and in parts, for every instruction set: must be one.
template <class Work> Told agreed(int n, int m, Work work) {
    Told expected(n, m);
    work(kernels(lanes::InstructionSet::baseline), 0, block_items, expected);
    for (const lanes::InstructionSet set : lanes::instruction_sets) {
        if (!lanes::is_supported(set)) continue;
        for (const int step : {1, 3, 5, 8, 13, static_cast<int>(block_items)}) {
            Told told(n, m);
            for (int first = 0; first < block_items; first += step)
                work(kernels(set), first, std::min<int>(step, block_items - first), told);
            CAPTURE(n, m, static_cast<int>(set), step);
            CHECK(told == expected);
        }
    }
    return expected;
}

Told update(Scene& scene, std::array<Outcome, block_items> given = {}) {
    return agreed(scene.n, scene.m, [&](const Kernels& by, int first, int items, Told& told) {
        std::copy_n(given.begin() + first, items, told.outcome.begin() + first);
        by.measurement(scene.n, scene.m, scene.seen)
            .update({scene.n, scene.m, scene.seen, items, scene.record.in(first), scene.jacobian.in(first),
                     scene.noise.in(first), scene.innovation.in(first), told.record.out(first),
                     told.likelihood.out(first), told.innovation.out(first), told.outcome.data() + first});
    });
}

}  // namespace

TEST_CASE("an update over lanes is the textbook's, for any sizes", "[kalman]") {
    struct Sizes {
        int n, m, seen;
    };
    for (const Sizes size : {Sizes{1, 1, 1},
                             {2, 1, 1},
                             {4, 2, 2},
                             {4, 2, 3},
                             {6, 3, 3},
                             {6, 2, 2},
                             {6, 3, 6},
                             {6, 4, 6},
                             {9, 3, 3},
                             {9, 2, 9},
                             {9, 3, 9},
                             {5, 3, 3},
                             {12, 6, 12},
                             {12, 3, 3}}) {
        const auto [n, m, seen] = size;
        CAPTURE(n, m, seen);
        Scene scene(n, m, seen);
        Told told = update(scene);
        for (int i = 0; i < block_items; ++i) {
            const MatrixXd p = scene.record.matrix(i, n, n, n), h = scene.jacobian.matrix(i, 0, m, n),
                           r = scene.noise.matrix(i, 0, m, m), e = scene.innovation.matrix(i, 0, m, 1);
            const MatrixXd s = product(product(h, p), h.transpose()) + r;
            const MatrixXd after = told.record.matrix(i, n, n, n),
                           shift = told.record.matrix(i, 0, n, 1) - scene.record.matrix(i, 0, n, 1);
            CHECK(told.outcome[static_cast<std::size_t>(i)] == Outcome::done);
            CHECK(largest(told.innovation.matrix(i, 0, m, m) - s) < 1e-13 * largest(s));
            CHECK(after == after.transpose());
            // K = P+ H' R^-1 tells x+ - x = K e.
            const MatrixXd cross = product(after, h.transpose());
            CHECK(largest(shift - product(cross, solved(r, e))) < 1e-11 * (1.0 + largest(shift)));
            // P = P+ + P+ H' (R - H P+ H')^-1 H P+: the update undone.
            const MatrixXd undone = product(cross, solved(r - product(h, cross), cross.transpose()));
            CHECK(largest(after + undone - p) < 1e-9 * largest(p));
            const double distance = product(e.transpose(), solved(s, e))(0);
            const double expected = -0.5 * (m * std::log(2.0 * std::acos(-1.0)) + log_determinant(s) + distance);
            CHECK(std::fabs(told.likelihood.numbers[static_cast<std::size_t>(i)] - expected) <
                  1e-11 * (1.0 + std::fabs(expected)));
        }
    }
}

TEST_CASE("one Jacobian and one noise for all items give what one for each gives", "[kalman]") {
    Scene scene(9, 3, 3);
    for (int i = 1; i < block_items; ++i) {
        scene.jacobian.matrix(i, 0, 3, 9) = scene.jacobian.matrix(0, 0, 3, 9);
        scene.noise.matrix(i, 0, 3, 3) = scene.noise.matrix(0, 0, 3, 3);
    }
    const Told expected = update(scene);
    const Told told = agreed(9, 3, [&](const Kernels& by, int first, int items, Told& out) {
        by.measurement(9, 3, 3).update({9,
                                        3,
                                        3,
                                        items,
                                        scene.record.in(first),
                                        {scene.jacobian.numbers.data(), 0},
                                        {scene.noise.numbers.data(), 0},
                                        scene.innovation.in(first),
                                        out.record.out(first),
                                        out.likelihood.out(first),
                                        out.innovation.out(first),
                                        out.outcome.data() + first});
    });
    CHECK(told == expected);
}

TEST_CASE("an item that fails says why, leaves its outputs, and touches no neighbour", "[kalman]") {
    for (const int n : {6, 7, 9}) {
        Scene scene(n, 3, 3);
        const Told good = update(scene);
        scene.record.matrix(2, n, n, n)(0, 0) = -1.0;
        scene.record.matrix(4, n, n, n)(n - 1, n - 1) = -1.0;
        scene.noise.matrix(5, 0, 3, 3)(1, 1) = -1.0;
        scene.innovation.matrix(7, 0, 3, 1)(2) = std::nan("");
        scene.jacobian.matrix(8, 0, 3, n)(0, 0) = std::nan("");
        scene.record.matrix(9, 0, n, 1)(n - 1) = std::numeric_limits<double>::infinity();
        scene.jacobian.matrix(11, 0, 3, n).setZero();
        scene.noise.matrix(11, 0, 3, 3).setZero();
        scene.record.matrix(12, n, n, n)(n - 1, 0) = std::nan("");
        std::array<Outcome, block_items> given{};
        given[14] = Outcome::not_finite;
        Told told = update(scene, given);
        const auto outcome = [&](int i) { return told.outcome[static_cast<std::size_t>(i)]; };
        CHECK(outcome(2) == Outcome::covariance_indefinite);
        CHECK(outcome(4) == Outcome::covariance_indefinite);
        CHECK(outcome(5) == Outcome::noise_indefinite);
        CHECK(outcome(7) == Outcome::not_finite);
        CHECK(outcome(8) == Outcome::not_finite);
        CHECK(outcome(9) == Outcome::not_finite);
        CHECK(outcome(11) == Outcome::innovation_singular);
        CHECK(outcome(12) == Outcome::covariance_indefinite);
        CHECK(outcome(14) == Outcome::not_finite);
        for (const int i : {2, 4, 5, 7, 8, 9, 11, 12, 14}) {
            CAPTURE(n, i);
            CHECK((told.record.matrix(i, 0, n + n * n, 1).array() == untouched).all());
            CHECK(told.likelihood.numbers[static_cast<std::size_t>(i)] == untouched);
        }
        for (const int i : {0, 1, 3, 6, 10, 13, 15}) {
            CHECK(outcome(i) == Outcome::done);
            CHECK(told.record.matrix(i, 0, n + n * n, 1) == Told(good).record.matrix(i, 0, n + n * n, 1));
        }
    }
}

TEST_CASE("projections over lanes are H P H' and P H'", "[kalman]") {
    struct Sizes {
        int n, m, seen;
    };
    for (const Sizes size : {Sizes{2, 1, 1}, {4, 2, 2}, {6, 3, 3}, {9, 3, 3}, {9, 3, 5}, {9, 2, 9}, {12, 6, 12}}) {
        const auto [n, m, seen] = size;
        CAPTURE(n, m, seen);
        Scene scene(n, m, seen);
        Told told = agreed(n, m, [&, n = n, m = m, seen = seen](const Kernels& by, int first, int items, Told& out) {
            by.measurement(n, m, seen)
                .project({n, m, seen, items, scene.record.in(first), scene.jacobian.in(first), out.projected.out(first),
                          out.cross.out(first), out.outcome.data() + first});
        });
        for (int i = 0; i < block_items; ++i) {
            const MatrixXd p = scene.record.matrix(i, n, n, n), h = scene.jacobian.matrix(i, 0, m, n);
            CHECK(largest(told.cross.matrix(i, 0, n, m) - product(p, h.transpose())) < 1e-13 * largest(p));
            CHECK(largest(told.projected.matrix(i, 0, m, m) - product(product(h, p), h.transpose())) <
                  1e-13 * n * largest(p));
        }
    }
}

TEST_CASE("predictions over lanes are F P F' + Q, by blocks and by full matrices, triangular or not", "[kalman]") {
    struct Sizes {
        int b, d;
    };
    for (const Sizes size : {Sizes{1, 1}, {2, 1}, {2, 2}, {2, 3}, {3, 2}, {3, 3}, {4, 3}, {5, 2}}) {
        const auto [b, d] = size;
        const int n = b * d;
        for (const bool upper : {true, false}) {
            CAPTURE(b, d, upper);
            Scene scene(n, 1, 1);
            Random random(5);
            Items f1(b * b), q1(b * b), f(n * n), q(n * n), mean(n);
            Numbers f1_lanes(static_cast<std::size_t>(b * b * block_items)), q1_lanes = f1_lanes;
            for (int i = 0; i < block_items; ++i) {
                f1.matrix(i, 0, b, b) = random.matrix(b, b);
                if (upper) f1.matrix(i, 0, b, b) = MatrixXd(f1.matrix(i, 0, b, b).triangularView<Eigen::Upper>());
                q1.matrix(i, 0, b, b) = random.covariance(b);
                for (int c = 0; c < n; ++c) {
                    for (int r = 0; r < n; ++r) {
                        f.matrix(i, 0, n, n)(r, c) = r % d == c % d ? f1.matrix(i, 0, b, b)(r / d, c / d) : 0.0;
                        q.matrix(i, 0, n, n)(r, c) = r % d == c % d ? q1.matrix(i, 0, b, b)(r / d, c / d) : 0.0;
                    }
                }
                for (int e = 0; e < b * b; ++e) {
                    f1_lanes[static_cast<std::size_t>(e * block_items + i)] = f1.matrix(i, 0, b * b, 1)(e);
                    q1_lanes[static_cast<std::size_t>(e * block_items + i)] = q1.matrix(i, 0, b * b, 1)(e);
                }
                mean.matrix(i, 0, n, 1) = product(f.matrix(i, 0, n, n), scene.record.matrix(i, 0, n, 1));
            }
            const auto blocks = [&, b = b, d = d](bool as_triangular) {
                return agreed(n, 1, [&](const Kernels& by, int first, int items, Told& out) {
                    // The lanes of a part begin at lane 0.
                    Numbers own_f(f1_lanes.size()), own_q(f1_lanes.size());
                    for (int e = 0; e < b * b; ++e) {
                        std::copy_n(&f1_lanes[static_cast<std::size_t>(e * block_items + first)], items,
                                    &own_f[static_cast<std::size_t>(e * block_items)]);
                        std::copy_n(&q1_lanes[static_cast<std::size_t>(e * block_items + first)], items,
                                    &own_q[static_cast<std::size_t>(e * block_items)]);
                    }
                    by.by_blocks(b, d)({b, d, as_triangular, false, items, own_f.data(), own_q.data(),
                                        scene.record.in(first), out.record.out(first), out.outcome.data() + first});
                });
            };
            Told told = blocks(upper);
            if (upper) CHECK(told == blocks(false));
            Told full = agreed(n, 1, [&](const Kernels& by, int first, int items, Told& out) {
                by.full(n)({n, items, f.in(first), q.in(first), mean.in(first), scene.record.in(first),
                            out.record.out(first), out.outcome.data() + first});
            });
            for (int i = 0; i < block_items; ++i) {
                const MatrixXd p = scene.record.matrix(i, n, n, n), transition = f.matrix(i, 0, n, n);
                const MatrixXd expected =
                    product(product(transition, p), transition.transpose()) + q.matrix(i, 0, n, n);
                for (Told* const by : {&told, &full}) {
                    CHECK(largest(by->record.matrix(i, n, n, n) - expected) < 1e-14 * n * n * (1.0 + largest(p)));
                    CHECK(largest(by->record.matrix(i, 0, n, 1) - mean.matrix(i, 0, n, 1)) < 1e-14 * n);
                }
            }
        }
    }
}

TEST_CASE("one transition for all items gives the bytes of one for each, zeros or not", "[kalman]") {
    for (const int n : {4, 6, 9, 10}) {
        CAPTURE(n);
        Scene scene(n, 1, 1);
        Random random(9);
        MatrixXd one = random.matrix(n, n).triangularView<Eigen::Upper>();
        one.col(n - 1).setZero();
        const MatrixXd noise = random.covariance(n);
        Items f(n * n), q(n * n), mean(n);
        for (int i = 0; i < block_items; ++i) {
            f.matrix(i, 0, n, n) = one;
            q.matrix(i, 0, n, n) = noise;
            mean.matrix(i, 0, n, 1) = product(one, scene.record.matrix(i, 0, n, 1));
        }
        const auto predicted = [&](bool common) {
            return agreed(n, 1, [&](const Kernels& by, int first, int items, Told& out) {
                by.full(n)({n, items, common ? ItemsIn{one.data(), 0} : f.in(first),
                            common ? ItemsIn{noise.data(), 0} : q.in(first), mean.in(first), scene.record.in(first),
                            out.record.out(first), out.outcome.data() + first});
            });
        };
        CHECK(predicted(true) == predicted(false));
    }
}

TEST_CASE("one F1 and Q1 for all items gives the bytes of one for each", "[kalman]") {
    for (const int d : {2, 3}) {
        for (const bool in_place : {false, true}) {
            CAPTURE(d, in_place);
            const int n = 2 * d;
            Scene scene(n, 1, 1);
            const double f1[] = {0.9, 0.0, 0.4, 1.1}, q1[] = {0.3, 0.2, 0.2, 0.5};
            Numbers f_lanes(4 * block_items), q_lanes(4 * block_items);
            for (std::size_t e = 0; e < f_lanes.size(); ++e) {
                f_lanes[e] = f1[e / block_items];
                q_lanes[e] = q1[e / block_items];
            }
            scene.record.matrix(1, 0, n, 1)(n - 1) = std::numeric_limits<double>::infinity();
            scene.record.matrix(3, n, n, n)(n - 1, n - 1) = std::nan("");
            scene.record.matrix(5, n, n, n).setZero();
            scene.record.matrix(5, 0, n, 1).setConstant(-0.0);
            scene.record.matrix(7, 0, n, 1).setConstant(1e308);  // each finite after the step, their sum is not
            scene.record.matrix(7, d, d, 1).setConstant(1e300);
            const auto predicted = [&](bool is_common) {
                return agreed(n, 1, [&](const Kernels& by, int first, int items, Told& out) {
                    const auto offset = static_cast<std::ptrdiff_t>(first * scene.record.stride);
                    if (in_place)
                        std::copy_n(scene.record.numbers.begin() + offset, items * scene.record.stride,
                                    out.record.numbers.begin() + offset);
                    out.outcome[11] = Outcome::covariance_indefinite;
                    by.by_blocks(2, d)({2, d, true, is_common, items, f_lanes.data(), q_lanes.data(),
                                        in_place ? out.record.in(first) : scene.record.in(first), out.record.out(first),
                                        out.outcome.data() + first});
                });
            };
            Told told = predicted(true);
            CHECK(told == predicted(false));
            for (const int i : {1, 3}) CHECK(told.outcome[static_cast<std::size_t>(i)] == Outcome::not_finite);
            CHECK(told.outcome[11] == Outcome::covariance_indefinite);
            for (const int i : {1, 3, 11}) {
                const auto left = told.record.matrix(i, 0, n + n * n, 1);
                if (in_place)
                    CHECK(std::memcmp(left.data(), scene.record.matrix(i, 0, n + n * n, 1).data(),
                                      static_cast<std::size_t>(n + n * n) * sizeof(double)) == 0);
                else
                    CHECK((left.array() == untouched).all());
            }
            for (const int i : {0, 5, 7, 15}) {
                CHECK(told.outcome[static_cast<std::size_t>(i)] == Outcome::done);
                const MatrixXd after = told.record.matrix(i, n, n, n);
                CHECK(after == after.transpose());
            }
        }
    }
}
