/// What a measurement with a noise R would leave of a predicted state: the criteria by which a waveform is chosen.
///
/// With S = H P H' + R, R = T R0 T', and C = P H', the covariance afterwards is P+ = P - C S^-1 C'. T acts on range and range rate
/// alone, so the angles are taken in once, and each candidate costs a few products of 2 x 2 matrices.
#pragma once

#include <cstring>
#include <limits>

#include "noise_transform.hpp"

namespace waveform {

constexpr int most_states = 12;  // Cartesian components

using Covariance = pelorus::small::Bounded<most_states, most_states>;
using Cross = pelorus::small::Bounded<most_states, most_measured>;

enum class Criterion { determinant, trace, position_trace, mutual_information };

/// A prediction and how a sensor sees it.
struct Prediction {
    Covariance covariance;  ///< P, c x c
    Noise projected;        ///< H P H', m x m
    Cross cross;            ///< P H', c x m
    int positions = 0;      ///< how many of the components are positions; they come first
};

/// Reads step j of item i of what choose is given.
inline Prediction load_prediction(const plr_waveform_choose& args, std::int64_t i, std::int64_t j) {
    const auto c = static_cast<Eigen::Index>(args.covariance.rows), m = static_cast<Eigen::Index>(args.projected.rows);
    Prediction out{Covariance(c, c), load_noise(args.projected, i, j * m), Cross(c, m), 0};
    for (Eigen::Index col = 0; col < c; ++col)
        for (Eigen::Index row = 0; row < c; ++row)
            out.covariance(row, col) =
                args.covariance.data[i * args.covariance.item_stride + (j * c + col) * args.covariance.col_stride +
                                     row * args.covariance.row_stride];
    for (Eigen::Index col = 0; col < m; ++col)
        for (Eigen::Index row = 0; row < c; ++row)
            out.cross(row, col) = args.cross.data[i * args.cross.item_stride + (j * m + col) * args.cross.col_stride +
                                                  row * args.cross.row_stride];
    const char* at = reinterpret_cast<const char*>(args.cartesian->components);
    for (std::uint32_t k = 0; k < args.cartesian->size; ++k) {
        const auto& component = *reinterpret_cast<const plr_component*>(at);
        if (std::strncmp(component.name, "position.", 9) != 0) break;
        ++out.positions;
        at += component.struct_size;
    }
    return out;
}

/// P+ of one noise. Throws NumericError where S is not positive definite.
inline Covariance posterior(const Prediction& prediction, const Noise& noise) {
    Noise s = prediction.projected + noise;
    if (!pelorus::small::cholesky(s, s)) throw pelorus::NumericError("H P H' + R is not positive definite");
    pelorus::small::Bounded<most_measured, most_states> gain = prediction.cross.transpose();
    pelorus::small::solve_lower(s, gain);
    Covariance out = prediction.covariance;
    for (Eigen::Index col = 0; col < out.cols(); ++col)
        for (Eigen::Index row = col; row < out.rows(); ++row) {
            double sum = out(row, col);
            for (Eigen::Index k = 0; k < gain.rows(); ++k) sum -= gain(k, row) * gain(k, col);
            out(row, col) = out(col, row) = sum;
        }
    return out;
}

class Outlook {
public:
    /// Throws NumericError where S of the angles is not positive definite.
    Outlook(const Prediction& prediction, const Noise& base, Criterion criterion) : criterion_(criterion) {
        const Eigen::Index angles = base.rows() - 2;
        Noise root(angles, angles);
        Block predicted(angles, 2), correlated(angles, 2);
        for (Eigen::Index c = 0; c < angles; ++c)
            for (Eigen::Index r = 0; r < angles; ++r)
                root(r, c) = prediction.projected(2 + r, 2 + c) + base(2 + r, 2 + c);
        for (Eigen::Index c = 0; c < 2; ++c)
            for (Eigen::Index r = 0; r < angles; ++r) {
                predicted(r, c) = prediction.projected(2 + r, c);
                correlated(r, c) = base(2 + r, c);
            }
        if (!pelorus::small::cholesky(root, root))
            throw pelorus::NumericError("H P H' + R of the angles is not positive definite");
        pelorus::small::solve_lower(root, predicted);
        pelorus::small::solve_lower(root, correlated);
        predicted_ = predicted;
        correlated_ = correlated;
        projected_ = prediction.projected.topLeftCorner<2, 2>();
        noise_ = base.topLeftCorner<2, 2>();
        if (is_determinant())
            take_determinants(base, root);
        else
            take_gains(prediction, root);
    }

    /// What the criterion makes of a waveform; smaller is better. Not finite where it leads to no covariance.
    ///   determinant           ln(det P+/det P) = ln(det R/det S)
    ///   mutual_information    that of state and measurement, negative, in nats: half of the above
    ///   trace, position_trace of P+ (numbers of m, m/s, m/s2 added up), or of its positions, m^2
    double operator()(const Transform& t) const noexcept {
        // A = S of range and range rate, given the angles: their covariance with the angles is L (X + Y T').
        Transform a = projected_ + turned(t, noise_);
        for (Eigen::Index k = 0; k < predicted_.rows(); ++k) {
            const double x[2] = {predicted_(k, 0) + correlated_(k, 0) * t(0, 0) + correlated_(k, 1) * t(0, 1),
                                 predicted_(k, 1) + correlated_(k, 0) * t(1, 0) + correlated_(k, 1) * t(1, 1)};
            for (int c = 0; c < 2; ++c)
                for (int r = 0; r < 2; ++r) a(r, c) -= x[r] * x[c];
        }
        const double determinant = a(0, 0) * a(1, 1) - a(1, 0) * a(0, 1);
        if (is_determinant())
            return (criterion_ == Criterion::mutual_information ? 0.5 : 1.0) * (others_ - std::log(determinant));
        if (!(determinant > 0)) return std::numeric_limits<double>::infinity();
        const Transform across = mixed_.lazyProduct(t.transpose());
        const Transform g = gains_ - across - across.transpose() + turned(t, noise_gains_);
        return others_ - (a(1, 1) * g(0, 0) - 2 * a(1, 0) * g(1, 0) + a(0, 0) * g(1, 1)) / determinant;
    }

private:
    using Block = pelorus::small::Bounded<most_measured, 2>;

    bool is_determinant() const noexcept {
        return criterion_ == Criterion::determinant || criterion_ == Criterion::mutual_information;
    }
    /// T A T'.
    static Transform turned(const Transform& t, const Transform& a) noexcept {
        const Transform half = t.lazyProduct(a);
        return half.lazyProduct(t.transpose());
    }

    /// ln(det R0/det S of the angles); det R = det R0.
    void take_determinants(const Noise& base, const Noise& root_of_angles) noexcept {
        Noise root = base;
        others_ = pelorus::small::cholesky(root, root)
                      ? pelorus::small::log_determinant(root) - pelorus::small::log_determinant(root_of_angles)
                      : -std::numeric_limits<double>::infinity();
    }

    /// Row i of C, less what the angles tell of it, is u - T w: with U, V, W the sums of u u', u w', w w' over the components that count,
    /// trace P+ = others - tr(A^-1 G), G = U - V T' - T V' + T W T'.
    void take_gains(const Prediction& prediction, const Noise& root_of_angles) noexcept {
        const Eigen::Index angles = predicted_.rows();
        const Eigen::Index counted =
            criterion_ == Criterion::trace ? prediction.covariance.rows() : Eigen::Index{prediction.positions};
        gains_.setZero();
        mixed_.setZero();
        noise_gains_.setZero();
        for (Eigen::Index i = 0; i < counted; ++i) {
            pelorus::small::Bounded<most_measured, 1> row(angles, 1);
            for (Eigen::Index k = 0; k < angles; ++k) row(k) = prediction.cross(i, 2 + k);
            pelorus::small::solve_lower(root_of_angles, row);
            double u[2] = {prediction.cross(i, 0), prediction.cross(i, 1)}, w[2] = {0, 0};
            others_ += prediction.covariance(i, i);
            for (Eigen::Index k = 0; k < angles; ++k) {
                others_ -= row(k) * row(k);
                for (int c = 0; c < 2; ++c) {
                    u[c] -= row(k) * predicted_(k, c);
                    w[c] += row(k) * correlated_(k, c);
                }
            }
            for (int c = 0; c < 2; ++c)
                for (int r = 0; r < 2; ++r) {
                    gains_(r, c) += u[r] * u[c];
                    mixed_(r, c) += u[r] * w[c];
                    noise_gains_(r, c) += w[r] * w[c];
                }
        }
    }

    Criterion criterion_;
    Block predicted_, correlated_;           // X, Y: angles x 2
    Transform projected_, noise_;            // of range and range rate: H P H', R0
    Transform gains_, mixed_, noise_gains_;  // U, V, W
    double others_ = 0;                      // what does not depend on the waveform
};

}  // namespace waveform
