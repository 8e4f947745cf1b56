/// How a waveform changes a sensor's noise: R = T R0 T', with T acting on range and range rate alone and det T = 1. So the
/// noise stays positive, its determinant is kept, and correlations with the angles go along.
///
/// All functions are pure: [worker, concurrent] [hot].
#pragma once

#include <algorithm>
#include <cmath>

#include <pelorus/batch_model.hpp>
#include <pelorus/small_matrix.hpp>

#include "gaussian_pulse.hpp"

namespace waveform {

constexpr int most_measured = 4;  // range, range rate, azimuth, elevation

using Noise = pelorus::small::Bounded<most_measured, most_measured>;
using Transform = pelorus::Matrix<2>;

/// What these models shape: range and range rate first, then the angles of the plane or of space.
inline pelorus::Space measurement_space(int dimension) {
    std::vector<pelorus::Component> components{
        {"range", "m", 0, 0, false}, {"range_rate", "m/s", 0, 0, false}, {"azimuth", "rad", 0, 0, true}};
    if (dimension == 3) components.push_back({"elevation", "rad", 0, 0, true});
    return pelorus::Space(std::move(components));
}

/// R = L' R0 L with L = [[cos phi, -sin phi], [sin phi, cos phi]] on the numbers of m and m/s: T = L'.
inline Transform rotation(double angle) noexcept {
    Transform out;
    out << std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle);
    return out;
}

/// A factor of a pulse's noise shape: M M' = [[S, -B S], [-B S, 1/S + B^2 S]], lower triangular, det M = 1.
inline Transform pulse_factor(const NormalisedPulse& pulse) noexcept {
    const double root = std::sqrt(pulse.length);
    Transform out;
    out << root, 0, -pulse.chirp * root, 1 / root;
    return out;
}

/// From the noise of one pulse to that of another: T = M(to) M(from)^-1.
inline Transform pulse_change(const NormalisedPulse& from, const NormalisedPulse& to) noexcept {
    const Transform m = pulse_factor(from);
    Transform inverse;
    inverse << m(1, 1), 0, -m(1, 0), m(0, 0);
    return pulse_factor(to).lazyProduct(inverse);
}

/// out = T R0 T'; may be R0 itself. Exactly symmetric.
inline void transform(const Transform& t, const Noise& base, Noise& out) noexcept {
    const Eigen::Index m = base.rows();
    Noise rows = base;
    for (Eigen::Index c = 0; c < m; ++c) {
        rows(0, c) = t(0, 0) * base(0, c) + t(0, 1) * base(1, c);
        rows(1, c) = t(1, 0) * base(0, c) + t(1, 1) * base(1, c);
    }
    out = rows;
    for (Eigen::Index r = 0; r < m; ++r) {
        out(r, 0) = t(0, 0) * rows(r, 0) + t(0, 1) * rows(r, 1);
        out(r, 1) = t(1, 0) * rows(r, 0) + t(1, 1) * rows(r, 1);
    }
    pelorus::small::symmetrise(out);
}

/// Item i of a view of m x m matrices.
inline Noise load_noise(const plr_const_view& from, std::int64_t i, std::int64_t first_column = 0) noexcept {
    const auto m = static_cast<Eigen::Index>(from.rows);
    Noise out(m, m);
    for (Eigen::Index c = 0; c < m; ++c)
        for (Eigen::Index r = 0; r < m; ++r)
            out(r, c) = from.data[i * from.item_stride + (first_column + c) * from.col_stride + r * from.row_stride];
    return out;
}

/// Throws NumericError where the noise is not finite.
inline void store_noise(const plr_view& to, std::int64_t i, const Noise& noise) {
    if (!pelorus::small::all_finite(noise)) throw pelorus::NumericError("the noise is not finite");
    for (Eigen::Index c = 0; c < noise.cols(); ++c)
        for (Eigen::Index r = 0; r < noise.rows(); ++r)
            to.data[i * to.item_stride + c * to.col_stride + r * to.row_stride] = noise(r, c);
}

}  // namespace waveform
