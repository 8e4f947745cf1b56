/// The arithmetic of a Gaussian filter's step that works on factors of the state's covariance, for blocks of items over lanes
/// (items.hpp says how these are handed over).
///
/// What a prediction or a measurement does to the state is told by a regression on the whitened state xi ~ N(0, I), x = mean +
/// S xi: the slope G (F S of a linear motion, H S of a linear sensor) and columns E of what the slope does not explain, so that
/// the image's covariance is G G' + E E' - u u' (u: a point of negative weight). Factors S and images are kept in memory of the
/// caller from one kernel to the next. A record begins with mean (n) and covariance or factor (n x n).
/// All functions are pure, [worker, concurrent] [hot]. An item's result is the same bytes whatever its neighbours and the
/// instruction set; items that fail leave their outputs alone, but for what parts are asked about.
#pragma once

#include "../lanes/instruction_set.hpp"
#include "items.hpp"

namespace gaussian {

/// Points of a rule, as kernels see it; see PointRule.
struct Points {
    int size = 0, count = 0;  // components of xi; the centre included
    bool is_star = false;
    double scale = 0.0;
    const double *points = nullptr, *mean_weights = nullptr, *covariance_weights = nullptr;
    /// That of the centre's residual, which is -shift; see points_of.
    double centre_weight = 0.0;
    bool about_centre = false;  // the other residuals are of the centre's image in place of the mean
};

/// What is kept of a block of images, and how much of it there is.
struct Image {
    double* kept = nullptr;     // image_doubles(rows, n) an item, room for whole groups
    int seen = 0;               // the columns of G from there on are zero
    int columns = 0;            // of E
    bool has_downdate = false;  // u
};
/// The lanes of the widest instruction set: memory that is kept has room for a multiple of as many items.
constexpr int most_lanes = 8;
constexpr int residual_columns(int rows, int n) noexcept { return (rows > n ? rows : n) + 1; }
constexpr int image_doubles(int rows, int n) noexcept { return rows * (n + residual_columns(rows, n) + 1); }
constexpr std::int64_t kept_items(std::int64_t items) noexcept {
    return (items + most_lanes - 1) / most_lanes * most_lanes;
}
/// The image that points give of a motion or a sensor; of a linear one, only its slope counts.
Image image_of(const Points& points, int rows, bool is_linear, double* kept) noexcept;

/// Factors of items' covariances, and points x + S xi made of them.
struct Placement {
    int states, items;
    bool is_root;      // records hold factors
    const int* order;  // [n] the components in the order in which the covariance is factored, or nullptr: as they are
    ItemsIn record;
    double* factors;  // kept, n x n an item: rows as the state has them; 0 of an item that fails
    const Points* points;
    const int* rows;  // [row_count] the state's components that the points are to have
    int row_count;
    ItemsOut out;  // row_count x p; of all items
    Outcome* outcome;
};

/// Factors, and the slope A S of a matrix A. Factors may be nullptr: not wanted.
struct Slope {
    int states, rows, seen, items;  // seen: columns of A from there on are zero
    bool is_root;
    ItemsIn record, matrix;  // A: rows x n, of which rows x seen is read
    double* factors;
    double* kept;
    Outcome* outcome;
};

/// The regression of f on the whitened state from the points' images: with y = f(x + S xi),
///     shift = sum w (y - y0), slope = sum w (y - y0 - shift) xi', columns e sqrt(w), e = y - y0 - shift - slope xi
/// so that the mean is y0 + shift and the covariance sum w (y - mean)(y - mean)' = G G' + E E' - u u' (S. Sarkka, Bayesian
/// Filtering and Smoothing, 2013, 5.5 and 6; I. Arasaratnam, S. Haykin, R. J. Elliott, Proceedings of the IEEE 95, 2007).
struct Regression {
    int rows, states, items;
    const Points* points;
    ItemsIn centre, differences;  // y0: rows; y - y0: rows x p
    ItemsOut mean;                // rows; of all items
    double* kept;
    Outcome* outcome;
};

/// A motion's noise: its covariance (n x n), or a factor of it (n x columns).
struct MotionNoise {
    enum class Kind { covariance, factor };
    ItemsIn data;
    Kind kind;
    int columns;  // of a factor
};

/// The record after a step, from the predicted mean and the image of the spread.
struct Spread {
    int states, items;
    bool is_root;
    Image image;
    MotionNoise noise;
    ItemsIn predicted;  // n
    ItemsOut out;       // mean and covariance or factor
    Outcome* outcome;
};

/// Prediction by blocks: F = F1 (x) I, Q = Q1 (x) I with F1, Q1 b x b and d axes.
struct FactorBlockStep {
    int derivatives, axes;  // b, d
    int items;
    bool is_root;
    const double* transition;  // element e of F1 of item i at e * block_items + i
    const double* noise;       // the same way: where records hold factors, that of Q1; else Q1
    ItemsIn record;
    ItemsOut out;
    Outcome* outcome;
};

/// H P H' = G G' + E E' - u u', and P H' = S G'.
struct FactorProjection {
    int states, measured, items;
    Image image;
    const double* factors;
    ItemsOut projected, cross;  // m x m; n x m
    Outcome* outcome;
};

/// The update by an array of rotations; see lanes::array_update.
struct FactorUpdate {
    int states, measured, items;
    bool is_root, is_reordered;  // is_reordered: the factors are triangular in an order of their own
    Image image;
    const double* factors;
    ItemsIn record, noise, innovation;
    ItemsOut out, log_likelihood, innovation_covariance;
    Outcome* outcome;
};

/// Kernels for sizes, chosen once for an instance or a sensor.
struct StateKernels {
    void (*place)(const Placement&);
    void (*slope)(const Slope&);
    void (*spread)(const Spread&);
};
struct LookKernels {
    void (*update)(const FactorUpdate&);
    void (*project)(const FactorProjection&);
};
using FactorBlockKernel = void (*)(const FactorBlockStep&);
using RegressionKernel = void (*)(const Regression&);

struct FactorKernels {
    StateKernels (*state)(int states);
    RegressionKernel (*regression)(int rows);
    FactorBlockKernel (*by_blocks)(int derivatives, int axes);
    LookKernels (*look)(int states, int measured);
};

/// Those of an instruction set that the processor supports.
const FactorKernels& factor_kernels(lanes::InstructionSet set) noexcept;

/// The kernels that `choose(kernels of an instruction set)` answers, for calls of few items and of many.
template <class Choose> auto factor_kernels_by_items(Choose choose) {
    return lanes::ByItems<decltype(choose(factor_kernels(lanes::InstructionSet::baseline)))>{
        choose(factor_kernels(lanes::InstructionSet::baseline)), choose(factor_kernels(lanes::best_instruction_set()))};
}

}  // namespace gaussian
