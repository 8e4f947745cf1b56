/// Mean and covariance of a mixture of Gaussians, and how models of different components meet in one space.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <pelorus/failure.hpp>
#include <pelorus/sensor.hpp>
#include <pelorus/small_matrix.hpp>

namespace imm {

constexpr int max_models = 8, max_state = 12, max_measurement = 6;

template <int Max> using Column = pelorus::small::Bounded<Max, 1>;
template <int Max> using Square = pelorus::small::Bounded<Max, Max>;

/// Moments of one model, in the components of the mixture.
template <int Max> struct Gaussian {
    Column<Max> mean;
    Square<Max> covariance;
};

/// Brings differences of angles to (-pi, pi].
template <class Vector> void wrap(const std::vector<int>& angles, Vector& difference) noexcept {
    for (const int index : angles) difference.data()[index] = pelorus::wrap_angle(difference.data()[index]);
}

/// The index of the largest of `count` weights.
inline int likeliest(const double* weights, int count) noexcept {
    return static_cast<int>(std::max_element(weights, weights + count) - weights);
}

/// Differences from the likeliest mean, about which angles are averaged, and their weighted mean.
template <int Max> struct Offsets {
    Column<Max> of[max_models];
    Column<Max> mean;
};
template <int Max>
Offsets<Max> offsets_of(const Gaussian<Max>* models, const double* weights, int count, const std::vector<int>& angles) {
    const Column<Max>& centre = models[likeliest(weights, count)].mean;
    Offsets<Max> out;
    out.mean = Column<Max>::Zero(centre.rows(), 1);
    for (int j = 0; j < count; ++j) {
        out.of[j] = models[j].mean - centre;
        wrap(angles, out.of[j]);
        out.mean += weights[j] * out.of[j];
    }
    for (int j = 0; j < count; ++j) out.of[j] -= out.mean;
    return out;
}

/// The mixture, moments matched: x = sum w x_j, P = sum w (P_j + (x_j - x)(x_j - x)').
template <int Max>
Gaussian<Max> mixture(const Gaussian<Max>* models, const double* weights, int count, const std::vector<int>& angles) {
    const Offsets<Max> apart = offsets_of(models, weights, count, angles);
    const auto n = models[0].mean.rows();
    Gaussian<Max> out{models[likeliest(weights, count)].mean + apart.mean, Square<Max>::Zero(n, n)};
    wrap(angles, out.mean);
    for (int j = 0; j < count; ++j) {
        if (weights[j] == 0) continue;
        out.covariance += weights[j] * models[j].covariance;
        pelorus::small::add_outer(weights[j], apart.of[j], out.covariance);
    }
    return out;
}

/// Which component of the mixture's space each component of a model is; the others it has not.
struct Place {
    std::vector<int> index;
    bool is_whole = false;  ///< it has all of them, in their order

    /// Moments of the model as moments of the mixture: what it has not enters with `prior`, uncorrelated.
    template <int Max>
    Gaussian<Max> widened(const double* mean, const double* covariance, const Gaussian<Max>& prior) const {
        const auto size = static_cast<int>(index.size());
        Gaussian<Max> out;
        if (is_whole) {
            out.mean = Eigen::Map<const Column<Max>>(mean, size, 1);
            out.covariance = Eigen::Map<const Square<Max>>(covariance, size, size);
            return out;
        }
        out = prior;
        for (int a = 0; a < size; ++a) {
            out.mean(at(a)) = mean[a];
            for (int b = 0; b < size; ++b) out.covariance(at(a), at(b)) = covariance[b * size + a];
        }
        return out;
    }
    /// And back: the components that the model has.
    template <int Max> void narrowed(const Gaussian<Max>& from, double* mean, double* covariance) const {
        const auto size = static_cast<int>(index.size());
        for (int a = 0; a < size; ++a) {
            mean[a] = from.mean(at(a));
            for (int b = 0; b < size; ++b) covariance[b * size + a] = from.covariance(at(a), at(b));
        }
    }
    int at(int component) const { return index[static_cast<std::size_t>(component)]; }
};

}  // namespace imm
