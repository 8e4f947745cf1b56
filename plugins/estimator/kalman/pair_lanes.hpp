/// The prediction of D coordinates and their D rates by one F1, upper triangular, and one Q1 for all items: lanes hold numbers of
/// one item.
///
/// A record, [mean (n), covariance (n x n)], is a row of columns of n = 2 D numbers, and F = F1 (x) I adds to each coordinate what
/// stands D further on. So an item's numbers need not be brought beside those of other items and back, which costs more than
/// the arithmetic. A window is `width` consecutive numbers from number `First` on; where its lanes differ (coordinate or rate),
/// coefficients do. Each number is found by the operations of predict_blocks_of (kalman_lanes.cpp), in their order: the
/// bytes are the same.
/// Threads  All functions are pure: [worker, concurrent] [hot]. For sources that pelorus_add_lanes compiles.
#pragma once

#include "../../common/gaussian/groups.hpp"
#include "kalman_kernels.hpp"

namespace kalman {

namespace PELORUS_LANES {

using lanes::all;
using lanes::Mask;
using lanes::Pack;
using lanes::width;

template <int D> class PairStep {
public:
    static constexpr int n = 2 * D, size = n + n * n, rates = n + D * n;  // where the columns of the rates begin

    explicit PairStep(const BlockStep& step) noexcept
        : own_(all(step.transition[0])),
          added_(all(step.transition[2 * gaussian::block_items])),
          rate_(all(step.transition[3 * gaussian::block_items])),
          own_noise_(all(step.noise[0])),
          shared_noise_(all(step.noise[gaussian::block_items])),
          rate_noise_(all(step.noise[3 * gaussian::block_items])) {}

    /// Answers whether all is finite; else `to` is left as it is. The two may be the same.
    bool operator()(const double* from, double* to) const noexcept {
        Pack coordinates[windows_of(rates)], after[windows_of(size - rates)];
        predict_coordinates(from, coordinates, std::make_integer_sequence<int, windows_of(rates)>{});
        predict_rates(from, after, std::make_integer_sequence<int, windows_of(size - rates)>{});
        if (!is_finite(coordinates, after)) return false;
        for (int k = 0; k < windows_of(rates); ++k)
            __builtin_memcpy(to + window(k, rates), &coordinates[k], sizeof(Pack));
        for (int k = 0; k < windows_of(size - rates); ++k)
            __builtin_memcpy(to + rates + window(k, size - rates), &after[k], sizeof(Pack));
        for (int c = 1; c < D; ++c)  // rounding tells the two triangles apart
            for (int r = 0; r < c; ++r) to[n + c * n + r] = to[n + r * n + c];
        return true;
    }

private:
    // Of `count` numbers, at least as many as there are lanes: the last window ends where they do, and may share some with the
    // one before.
    static constexpr int windows_of(int count) noexcept { return (count + width - 1) / width; }
    static constexpr int window(int k, int count) noexcept {
        return (k + 1) * width <= count ? k * width : count - width;
    }

    static constexpr bool is_coordinate(int e) noexcept { return e % n < D; }
    /// Whether F adds the noise of block (row, column) of Q1, or of (column, row), to number e.
    static constexpr bool has_noise(int e, int row, int column) noexcept {
        if (e < n || (e % n) % D != (e / n - 1) % D) return false;
        const int r = e % n / D, c = (e / n - 1) / D;
        return (r == row && c == column) || (r == column && c == row);
    }

    template <int First, int... Lane> static Mask coordinates_of(std::integer_sequence<int, Lane...>) noexcept {
        return Mask{(is_coordinate(First + Lane) ? -1 : 0)...};
    }
    template <int First, int... Lane> static Mask mean_of(std::integer_sequence<int, Lane...>) noexcept {
        return Mask{(First + Lane < n ? -1 : 0)...};
    }
    template <int First, int Row, int Column, int... Lane>
    static Mask noise_of(std::integer_sequence<int, Lane...>) noexcept {
        return Mask{(has_noise(First + Lane, Row, Column) ? -1 : 0)...};
    }
    using Lanes = std::make_integer_sequence<int, width>;

    /// Of what stands at its place and D further on, F's part in a number.
    template <int First> Pack own() const noexcept { return coordinates_of<First>(Lanes{}) ? own_ : rate_; }
    template <int First> Pack added() const noexcept { return coordinates_of<First>(Lanes{}) ? added_ : Pack{}; }
    template <int First> Pack noise() const noexcept {
        const Pack some = noise_of<First, 0, 0>(Lanes{}) ? own_noise_ : Pack{};
        const Pack more = noise_of<First, 1, 0>(Lanes{}) ? shared_noise_ : some;
        return noise_of<First, 1, 1>(Lanes{}) ? rate_noise_ : more;
    }

    /// A window of a record; 0 beyond its end.
    template <int First> static Pack load(const double* record) noexcept {
        Pack out;
        __builtin_memcpy(&out, record + (First + width <= size ? First : size - width), sizeof out);
        if constexpr (First + width > size) out = moved<First + width - size>(out, Lanes{});
        return out;
    }
    template <int Count, int... Lane>
    static Pack moved(const Pack& numbers, std::integer_sequence<int, Lane...>) noexcept {
        return __builtin_shuffle(numbers, Pack{}, Mask{(Lane + Count < width ? Lane + Count : width)...});
    }

    /// A window of F [mean, covariance].
    template <int First> Pack left(const double* record) const noexcept {
        return own<First>() * load<First>(record) + added<First>() * load<First + D>(record);
    }
    /// The mean and the columns of the coordinates. A sum of zeros is +0 for the noise's sake.
    template <int First> Pack predict_coordinates_at(const double* record) const noexcept {
        const Mask mean = mean_of<First>(Lanes{});
        const Pack own = mean ? all(1.0) : own_, added = mean ? Pack{} : added_;
        return own * left<First>(record) + added * left<First + D * n>(record) + noise<First>();
    }
    /// The columns of the rates: what lies beside the diagonal as the rows of the rates, of which it is the image.
    template <int First> Pack predict_rates_at(const double* record) const noexcept {
        return own<First>() * (rate_ * load<First>(record)) + added<First>() * (rate_ * load<First + D>(record)) +
               noise<First>();
    }
    template <int... K>
    void predict_coordinates(const double* record, Pack* out, std::integer_sequence<int, K...>) const noexcept {
        ((out[K] = predict_coordinates_at<window(K, rates)>(record)), ...);
    }
    template <int... K>
    void predict_rates(const double* record, Pack* out, std::integer_sequence<int, K...>) const noexcept {
        ((out[K] = predict_rates_at<rates + window(K, size - rates)>(record)), ...);
    }

    /// Sums of finite numbers that are not finite are looked into.
    static bool is_finite(const Pack* coordinates, const Pack* after) noexcept {
        Pack sum{}, check{};
        for (int k = 0; k < windows_of(rates); ++k) sum += coordinates[k];
        for (int k = 0; k < windows_of(size - rates); ++k) sum += after[k];
        if (!lanes::any(~lanes::is_finite(sum))) return true;
        for (int k = 0; k < windows_of(rates); ++k) check += 0.0 * coordinates[k];
        for (int k = 0; k < windows_of(size - rates); ++k) check += 0.0 * after[k];
        return !lanes::any(~(check == 0.0));
    }

    Pack own_, added_, rate_;  // F1: [own, added; 0, rate]
    Pack own_noise_, shared_noise_, rate_noise_;
};

template <int D> void predict_pairs(const BlockStep& step) noexcept {
    const PairStep<D> predict(step);
    for (int i = 0; i < step.items; ++i) {
        if (step.outcome[i] == Outcome::done &&
            !predict(step.record.first + i * step.record.stride, step.out.first + i * step.out.stride))
            step.outcome[i] = Outcome::not_finite;
    }
    lanes::leave_lanes();
}

}  // namespace PELORUS_LANES

}  // namespace kalman
