// Kernels over lanes for the state: its factors, points made of them, and predictions. Includes nothing that has inline
// functions of its own: see plugins/common/lanes/pack.hpp.
#include "factor_kernels.hpp"
#include "groups.hpp"

namespace gaussian {

inline namespace PELORUS_LANES {

namespace {

using namespace lanes;

// ------------------------------------------------------------------------------------------- factors and points

/// The factor of the items' covariances, its rows as the state has them; 0 where there is none.
template <class N>
void load_factor(N size, bool is_root, const int* order, const ItemsIn& record, const Group& group, Pack* factor,
                 Mask& failed) noexcept {
    const int n = size;
    constexpr int most = most_states<N>;
    Pack own[most * most];
    load_items({record.first + n, record.stride}, group, n * n, own);
    if (order == nullptr && is_root) {
        for (int e = 0; e < n * n; ++e) factor[e] = own[e];
        return;
    }
    if (order == nullptr) {
        cholesky_semidefinite(size, own, factor, failed);
        clear_above_diagonal(size, factor);
    } else {
        Pack ordered[most * most];
        for (int c = 0; c < n; ++c)
            for (int r = 0; r < n; ++r) ordered[c * n + r] = own[(is_root ? c : order[c]) * n + order[r]];
        if (is_root)
            triangularise_rows(size, size, ordered);
        else
            cholesky_semidefinite(size, ordered, ordered, failed);
        clear_above_diagonal(size, ordered);
        for (int c = 0; c < n; ++c)
            for (int r = 0; r < n; ++r) factor[c * n + order[r]] = ordered[c * n + r];
    }
    for (int e = 0; e < n * n; ++e) factor[e] = failed ? Pack{} : factor[e];
}

/// All points of a star at once: pairs about the centre.
template <class N>
void place_star(N size, const Placement& task, const Group& group, const Pack* mean, const Pack* factor) noexcept {
    const int n = size, rows = task.row_count;
    constexpr int most = most_states<N>;
    Pack out[most * (2 * most + 1)];
    for (int k = 0; k < rows; ++k) out[k] = mean[task.rows[k]];
    for (int j = 0; j < task.points->size; ++j) {
        for (int k = 0; k < rows; ++k) {
            const Pack step = task.points->scale * factor[j * n + task.rows[k]];
            out[(1 + 2 * j) * rows + k] = out[k] + step;
            out[(2 + 2 * j) * rows + k] = out[k] - step;
        }
    }
    store_all(out, task.points->count * rows, group, task.out);
}

template <class N>
void place_each(N size, const Placement& task, const Group& group, const Pack* mean, const Pack* factor) noexcept {
    const int n = size, rows = task.row_count;
    for (int p = 0; p < task.points->count; ++p) {
        const double* const xi = task.points->points + p * task.points->size;
        Pack out[room(most_states<N>)];
        for (int k = 0; k < rows; ++k) {
            out[k] = mean[task.rows[k]];
            for (int j = 0; j < task.points->size; ++j) out[k] += factor[j * n + task.rows[k]] * xi[j];
        }
        store_all(out, rows, group, {task.out.first + p * rows, task.out.stride});
    }
}

template <class N> void place_of(N size, const Placement& task) noexcept {
    const int n = size;
    constexpr int most = most_states<N>;
    for (Group group{task.outcome, task.items}; group.is_left(); group.next()) {
        Pack mean[most], factor[most * most];
        Mask indefinite{};
        load_items(task.record, group, size, mean);
        load_factor(size, task.is_root, task.order, task.record, group, factor, indefinite);
        keep(factor, n * n, beside(task.factors, group, n * n));
        if (task.points->is_star)
            place_star(size, task, group, mean, factor);
        else
            place_each(size, task, group, mean, factor);
        note(group, indefinite, Outcome::covariance_indefinite, task.outcome);
    }
    leave_lanes();
}

template <class N> void slope_of(N size, const Slope& task) noexcept {
    const int n = size, rows = task.rows;
    constexpr int most = most_states<N>;
    for (Group group{task.outcome, task.items}; group.is_left(); group.next()) {
        Pack factor[most * most], matrix[max_state * most], slope[max_state * most];
        Mask indefinite{};
        load_factor(size, task.is_root, nullptr, task.record, group, factor, indefinite);
        load_items(task.matrix, group, rows * task.seen, matrix);
        for (int c = 0; c < task.seen; ++c) {  // S is triangular
            for (int r = 0; r < rows; ++r) {
                Pack sum{};
                for (int k = c; k < task.seen; ++k) sum += matrix[k * rows + r] * factor[c * n + k];
                slope[c * rows + r] = sum;
            }
        }
        if (task.factors != nullptr) keep(factor, n * n, beside(task.factors, group, n * n));
        keep(slope, rows * task.seen, beside(task.kept, group, image_doubles(rows, n)));
        note(group, indefinite, Outcome::covariance_indefinite, task.outcome);
    }
    leave_lanes();
}

// --------------------------------------------------------------------------------------------------- prediction

/// out += C C', lower triangle.
template <class N> void add_columns(N size, int columns, const Pack* c, Pack* out) noexcept {
    const int n = size;
    for (int j = 0; j < n; ++j) {
        for (int i = j; i < n; ++i) {
            Pack sum = out[j * n + i];
            for (int k = 0; k < columns; ++k) sum += c[k * n + i] * c[k * n + j];
            out[j * n + i] = sum;
        }
    }
}

/// The triangle of a factor of any number of columns, or the lower triangle of its square.
template <class N>
void gather_noise(N size, bool is_root, const MotionNoise& noise, const Group& group, Pack* out) noexcept {
    const int n = size;
    constexpr int most = most_states<N>;
    for (int e = 0; e < n * n; ++e) out[e] = Pack{};
    for (int first = 0; first < noise.columns; first += most) {
        Pack columns[most * most];
        const int count = noise.columns - first < most ? noise.columns - first : most;
        load_items({noise.data.first + first * n, noise.data.stride}, group, count * n, columns);
        if (is_root)
            append_columns(size, count, out, columns);
        else
            add_columns(size, count, columns, out);
    }
}

/// S = the triangle of [N G E], less u u'; N N' = Q.
template <class N>
void spread_root(N size, const Spread& task, const Group& group, Pack* slope, Pack* residual, Pack* u,
                 Pack* out) noexcept {
    const int n = size;
    constexpr int most = most_states<N>;
    Mask noise_indefinite{}, indefinite{};
    if (task.noise.kind == MotionNoise::Kind::covariance) {
        load_items(task.noise.data, group, n * n, out);
        cholesky_semidefinite(size, out, out, noise_indefinite);
        clear_above_diagonal(size, out);
        note(group, noise_indefinite, Outcome::motion_noise_indefinite, task.outcome);
    } else {
        gather_noise(size, true, task.noise, group, out);
    }
    append_columns(size, size, out, slope);
    append_columns(size, task.image.columns, out, residual);
    if (!task.image.has_downdate) return;
    Pack scratch[most];
    downdate(size, out, u, scratch, indefinite);
    note(group, indefinite, Outcome::prediction_indefinite, task.outcome);
}

/// P = Q + G G' + E E' - u u'.
template <class N>
void spread_plain(N size, const Spread& task, const Group& group, const Pack* slope, const Pack* residual,
                  const Pack* u, Pack* out) noexcept {
    const int n = size;
    constexpr int most = most_states<N>;
    if (task.noise.kind == MotionNoise::Kind::covariance) {
        Pack q[most * most];
        load_items(task.noise.data, group, n * n, q);
        for (int c = 0; c < n; ++c)
            for (int r = c; r < n; ++r) out[c * n + r] = 0.5 * (q[c * n + r] + q[r * n + c]);
    } else {
        gather_noise(size, false, task.noise, group, out);
    }
    add_columns(size, n, slope, out);
    add_columns(size, task.image.columns, residual, out);
    Mask indefinite{};
    for (int c = 0; c < n; ++c) {
        for (int r = c; r < n; ++r) {
            if (task.image.has_downdate) out[c * n + r] -= u[r] * u[c];
            out[r * n + c] = out[c * n + r];
        }
        indefinite |= out[c * n + c] < 0.0;
    }
    note(group, indefinite, Outcome::prediction_indefinite, task.outcome);
}

template <class N> void spread_of(N size, const Spread& task) noexcept {
    const int n = size;
    constexpr int most = most_states<N>;
    for (Group group{task.outcome, task.items}; group.is_left(); group.next()) {
        Pack slope[most * most], residual[most * (most + 1)], u[most], out[most + most * most];
        const double* const kept = beside(task.image.kept, group, image_doubles(n, n));
        load_items(task.predicted, group, size, out);
        recall(kept, n * n, slope);
        recall(kept + n * n * width, n * task.image.columns, residual);
        if (task.image.has_downdate) recall(kept + n * (n + residual_columns(n, n)) * width, n, u);
        note(group, ~(check_finite(n, out) == 0.0), Outcome::not_finite, task.outcome);
        if (task.is_root)
            spread_root(size, task, group, slope, residual, u, out + n);
        else
            spread_plain(size, task, group, slope, residual, u, out + n);
        note(group, ~(check_finite(n + n * n, out) == 0.0), Outcome::not_finite, task.outcome);
        store_items(out, n + n * n, group, task.out);
    }
    leave_lanes();
}

/// A state is a d x b array whose columns are the derivatives: F x is X F1'.
template <class B, class D> void blocks_of(B derivatives, D axes, const FactorBlockStep& step) noexcept {
    const auto size = times(derivatives, axes);
    const int b = derivatives, d = axes, n = size;
    constexpr int most = most_states<decltype(times(derivatives, axes))>;
    for (Group group{step.outcome, step.items}; group.is_left(); group.next()) {
        Pack f[most * most], q[most * most], mean[most], factor[most * most], slope[most * most],
            out[most + most * most];
        for (int e = 0; e < b * b; ++e) {
            __builtin_memcpy(&f[e], step.transition + e * block_items + group.first, sizeof(Pack));
            __builtin_memcpy(&q[e], step.noise + e * block_items + group.first, sizeof(Pack));
        }
        Mask indefinite{};
        load_items(step.record, group, size, mean);
        load_factor(size, step.is_root, nullptr, step.record, group, factor, indefinite);
        note(group, indefinite, Outcome::covariance_indefinite, step.outcome);
        for (int c = 0; c <= n; ++c) {
            const Pack* const x = c == 0 ? mean : factor + (c - 1) * n;
            Pack* const y = c == 0 ? out : slope + (c - 1) * n;
            const int first = c == 0 ? 0 : (c - 1) / d;  // S is 0 above its diagonal
            for (int r = 0; r < b; ++r) {
                for (int axis = 0; axis < d; ++axis) {
                    Pack sum{};
                    for (int k = first; k < b; ++k) sum += f[k * b + r] * x[k * d + axis];
                    y[r * d + axis] = sum;
                }
            }
        }
        Pack* const spread = out + n;
        for (int e = 0; e < n * n; ++e) spread[e] = Pack{};
        for (int c = 0; c < b; ++c)
            for (int r = c; r < b; ++r)
                for (int axis = 0; axis < d; ++axis) spread[(c * d + axis) * n + r * d + axis] = q[c * b + r];
        if (step.is_root) {
            append_columns(size, size, spread, slope);
        } else {
            add_columns(size, n, slope, spread);
            for (int c = 0; c < n; ++c)
                for (int r = c; r < n; ++r) spread[r * n + c] = spread[c * n + r];
        }
        note(group, ~(check_finite(n + n * n, out) == 0.0), Outcome::not_finite, step.outcome);
        store_items(out, n + n * n, group, step.out);
    }
    leave_lanes();
}

// ------------------------------------------------------------------------------- the sizes that are compiled for

template <class N> StateKernels state_of() noexcept {
    return {[](const Placement& task) { place_of(N{}, task); }, [](const Slope& task) { slope_of(N{}, task); },
            [](const Spread& task) { spread_of(N{}, task); }};
}

StateKernels state(int n) noexcept {
    if (n == 4) return state_of<Fixed<4>>();
    if (n == 6) return state_of<Fixed<6>>();
    if (n == 9) return state_of<Fixed<9>>();
    return {[](const Placement& task) { place_of(task.states, task); },
            [](const Slope& task) { slope_of(task.states, task); },
            [](const Spread& task) { spread_of(task.states, task); }};
}

template <int B, int D> FactorBlockKernel fixed_blocks() noexcept {
    return [](const FactorBlockStep& step) { blocks_of(Fixed<B>{}, Fixed<D>{}, step); };
}

FactorBlockKernel by_blocks(int b, int d) noexcept {
    if (b == 2 && d == 2) return fixed_blocks<2, 2>();
    if (b == 2 && d == 3) return fixed_blocks<2, 3>();
    if (b == 3 && d == 2) return fixed_blocks<3, 2>();
    if (b == 3 && d == 3) return fixed_blocks<3, 3>();
    return [](const FactorBlockStep& step) { blocks_of(step.derivatives, step.axes, step); };
}

}  // namespace

RegressionKernel regression(int rows) noexcept;       // regression_lanes.cpp
LookKernels look(int states, int measured) noexcept;  // look_lanes.cpp

extern const FactorKernels kernels;
const FactorKernels kernels{&state, &regression, &by_blocks, &look};

}  // namespace PELORUS_LANES

}  // namespace gaussian
