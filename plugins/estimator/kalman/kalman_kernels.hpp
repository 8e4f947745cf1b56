/// The arithmetic of the Kalman filter on blocks of items, over lanes (plugins/common/lanes).
///
/// plugins/common/gaussian/items.hpp says how blocks are handed over. A record begins with mean (n) and covariance (n x n,
/// symmetric). An item that fails leaves its outputs as they are.
/// All functions are pure, [worker, concurrent] [hot]; records may be the outputs that replace them.
#pragma once

#include "../../common/gaussian/items.hpp"
#include "../../common/lanes/instruction_set.hpp"

namespace kalman {

using gaussian::block_items;
using gaussian::ItemsIn;
using gaussian::ItemsOut;
using gaussian::max_measurement;
using gaussian::max_state;
using gaussian::Outcome;

/// Prediction by blocks: F = F1 (x) I, Q = Q1 (x) I with F1, Q1 b x b and d axes.
struct BlockStep {
    int derivatives, axes;  // b, d
    bool upper_triangular;  // F1 has zeros below its diagonal, for all items: these are left out
    bool is_common;         // F1 and Q1 of the first item are those of all
    int items;
    const double* transition;  // element e of F1 of item i at e * block_items + i
    const double* noise;       // Q1, the same way
    ItemsIn record;
    ItemsOut out;  // mean and covariance
    Outcome* outcome;
};

/// Prediction by full matrices: the predicted mean is given, the covariance becomes F P F' + (Q + Q') / 2.
struct FullStep {
    int states, items;
    ItemsIn transition, noise;  // n x n
    ItemsIn predicted;          // n
    ItemsIn record;
    ItemsOut out;
    Outcome* outcome;
};

/// H P H' and P H'.
struct Projection {
    int states, measured, seen, items;  // seen: columns of H from there on are zero
    ItemsIn record, jacobian;           // H: m x n, of which m x seen is read
    ItemsOut projected;                 // m x m
    ItemsOut cross;                     // n x m
    Outcome* outcome;
};

/// The update, in Joseph's form from factors.
///
/// With P = L L', R = N N' and G = H L, reflections take [G N; L 0] to [Z 0; T L+] (lanes::reflect_update): Z is the factor of
/// S = G G' + R, so that S itself, in which a small R beside a large P would be lost, is never formed; K = T Z^-1; and L+ L+',
/// a sum of squares, is the updated P, which is (L - K G)(L - K G)' + (K N)(K N)'. The only Cholesky factorisations are those of P and
/// R, which accept singular matrices. Where H sees only the leading components, G has no other columns, and the others of
/// L stay as they are.
struct Update {
    int states, measured, seen, items;
    ItemsIn record, jacobian, noise, innovation;
    ItemsOut out;
    ItemsOut log_likelihood, innovation_covariance;
    Outcome* outcome;
};

/// Kernels for sizes, chosen once for an instance or a sensor.
using BlockKernel = void (*)(const BlockStep&);
using FullKernel = void (*)(const FullStep&);
struct MeasurementKernels {
    void (*update)(const Update&);
    void (*project)(const Projection&);
};
struct Kernels {
    BlockKernel (*by_blocks)(int derivatives, int axes);
    FullKernel (*full)(int states);
    MeasurementKernels (*measurement)(int states, int measured, int seen);
};

/// Those of an instruction set that the processor supports.
const Kernels& kernels(lanes::InstructionSet set) noexcept;

}  // namespace kalman
