/// The arithmetic of one item of a Gaussian filter's step that works on factors of the state's covariance.
///
/// What a prediction or a measurement does to the state is told by a regression on the whitened state xi ~ N(0, I), x = mean +
/// S xi: the slope G (F S of a linear motion, H S of a linear sensor) and columns E of what the slope does not explain, so that
/// the image's covariance is G G' + E E' - u u' (u: a point of negative weight). Arrays are packed, column-major and the
/// caller's. [worker, concurrent] [hot].
#pragma once

#include "filter.hpp"

namespace gaussian {

/// The image of the state's distribution under a motion or a sensor.
struct Image {
    double* slope = nullptr;     // rows x n; used up
    double* residual = nullptr;  // rows x columns; used up
    int columns = 0;
    double* downdate = nullptr;  // rows, or nullptr; used up
};

/// A motion's noise: its covariance (n x n), a factor of it (n x columns), or a lower triangular one (n x n).
struct MotionNoise {
    enum class Kind { covariance, factor, triangle };
    const double* data = nullptr;
    Kind kind = Kind::covariance;
    int columns = 0;  // of a factor
};

/// What an update needs besides the image of the state.
struct Measured {
    const double* mean;        // n: the state's before
    const double* factor;      // n x n: S
    const double* noise;       // m x m: R
    const double* innovation;  // m
};
/// What an update tells.
struct Updated {
    double* mean;                   // n
    double* spread;                 // n x n: as the form says
    double* log_likelihood;         // or nullptr
    double* innovation_covariance;  // m x m, or nullptr
};

/// The predicted covariance or its factor, n x n. `out` may be what the slope was made from.
using PredictSpread = Outcome (*)(int n, const Image& image, const MotionNoise& noise, double* out);
using Update = Outcome (*)(int n, int m, const Image& image, const Measured& z, const Updated& out);

PredictSpread predict_kernel(Form form, int n) noexcept;
Update update_kernel(Form form, int n, int m) noexcept;

/// out = G G' + E E' - u u', rows x rows.
void image_covariance(int rows, int n, const Image& image, double* out) noexcept;

}  // namespace gaussian
