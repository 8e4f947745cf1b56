// The kernels over lanes, compiled once for each instruction set. Includes nothing that has inline functions of its own: see
// plugins/common/lanes/pack.hpp.
#include "../../common/gaussian/groups.hpp"
#include "kalman_kernels.hpp"
#include "pair_lanes.hpp"

namespace kalman {

namespace PELORUS_LANES {

namespace {

using namespace lanes;

using namespace gaussian::PELORUS_LANES;

template <class B, class D> constexpr int most_in_blocks = max_state;
template <int B, int D> constexpr int most_in_blocks<Fixed<B>, Fixed<D>> = B* D;

/// 0 unless a number is infinite or NaN; reads the lower triangle of the covariance.
Pack check_record(int n, const Pack* record) noexcept {
    Pack check{};
    for (int i = 0; i < n; ++i) check += 0.0 * record[i];
    for (int j = 0; j < n; ++j)
        for (int i = j; i < n; ++i) check += 0.0 * record[n + j * n + i];
    return check;
}

// -------------------------------------------------------------------------------------------------- prediction

/// Sums begin with +0, so that a zero of F1 makes no difference in a bit, be it left out or not.
template <class B, class D, bool upper> void predict_blocks_of(B derivatives, D axes, const BlockStep& step) noexcept {
    const int b = derivatives, d = axes, n = b * d;
    constexpr int most = most_in_blocks<B, D>;
    for (Group group{step.outcome, step.items}; group.is_left(); group.next()) {
        Pack f[most * most], q[most * most], from[most + most * most], left[most * most], out[most + most * most];
        for (int e = 0; e < b * b; ++e) {
            __builtin_memcpy(&f[e], step.transition + e * block_items + group.first, sizeof(Pack));
            __builtin_memcpy(&q[e], step.noise + e * block_items + group.first, sizeof(Pack));
        }
        load_items(step.record, group, n + n * n, from);
        // The mean and the columns of F P: a state is a d x b array whose columns are the derivatives, F x is X F1'.
        for (int c = 0; c <= n; ++c) {
            const Pack* const x = from + c * n;
            Pack* const y = c == 0 ? out : left + (c - 1) * n;
            for (int r = 0; r < b; ++r) {
                for (int axis = 0; axis < d; ++axis) {
                    Pack sum{};
                    for (int k = upper ? r : 0; k < b; ++k) sum += f[k * b + r] * x[k * d + axis];
                    y[r * d + axis] = sum;
                }
            }
        }
        for (int r = 0; r < b; ++r) {
            for (int axis = 0; axis < d; ++axis) {
                const int column = r * d + axis;
                for (int i = column; i < n; ++i) {
                    Pack sum{};
                    for (int k = upper ? r : 0; k < b; ++k) sum += f[k * b + r] * left[(k * d + axis) * n + i];
                    out[n + column * n + i] = sum;
                }
                for (int k = r; k < b; ++k) out[n + column * n + k * d + axis] += q[r * b + k];
                for (int i = column; i < n; ++i) out[n + i * n + column] = out[n + column * n + i];
            }
        }
        note(group, ~(check_record(n, from) + check_record(n, out) == 0.0), Outcome::not_finite, step.outcome);
        store_items(out, n + n * n, group, step.out);
    }
    leave_lanes();
}

/// left = F P and out = left F' + Q, with the elements of F and of (Q + Q') / 2 as `transition` and `noise` tell them: Packs, or
/// numbers that are common to all lanes. In the latter case the zeros of F are skipped: sums begin with +0, so that the bytes
/// are the same.
template <class N, class Coefficient>
void congruence(N size, const Coefficient* f, const Coefficient* q, const Pack* p, Pack* out) noexcept {
    const int n = size;
    constexpr int most = most_states<N>;
    constexpr bool common = sizeof(Coefficient) == sizeof(double);
    int first[most][most], used[most];  // of row r: the columns of F that are not zero
    for (int r = 0; r < n; ++r) {
        used[r] = 0;
        for (int k = 0; k < n; ++k) {
            bool zero = false;
            if constexpr (common) zero = f[k * n + r] == 0.0;
            if (!zero) first[r][used[r]++] = k;
        }
    }
    Pack left[most * most];
    for (int c = 0; c < n; ++c) {
        for (int r = 0; r < n; ++r) {
            Pack sum{};
            for (int u = 0; u < used[r]; ++u) sum += f[first[r][u] * n + r] * p[c * n + first[r][u]];
            left[c * n + r] = sum;
        }
    }
    for (int c = 0; c < n; ++c) {
        for (int i = c; i < n; ++i) {
            Pack sum = 0.5 * (q[c * n + i] + q[i * n + c]) + Pack{};
            for (int u = 0; u < used[c]; ++u) sum += f[first[c][u] * n + c] * left[first[c][u] * n + i];
            out[c * n + i] = out[i * n + c] = sum;
        }
    }
}

template <class N> void predict_full_of(N size, const FullStep& step) noexcept {
    const int n = size;
    constexpr int most = most_states<N>;
    const bool common = step.transition.stride == 0 && step.noise.stride == 0;
    for (Group group{step.outcome, step.items}; group.is_left(); group.next()) {
        Pack from[most + most * most], out[most + most * most];
        load_items(step.record, group, n + n * n, from);
        load_items(step.predicted, group, size, out);
        if (common) {
            congruence(size, step.transition.first, step.noise.first, from + n, out + n);
        } else {
            Pack f[most * most], q[most * most];
            load_items(step.transition, group, n * n, f);
            load_items(step.noise, group, n * n, q);
            congruence(size, f, q, from + n, out + n);
        }
        note(group, ~(check_record(n, from) + check_record(n, out) == 0.0), Outcome::not_finite, step.outcome);
        store_items(out, n + n * n, group, step.out);
    }
    leave_lanes();
}

// ------------------------------------------------------------------------------------------------ measurements

/// out = H A for an m x seen H and the first `seen` rows of an A of n rows; reads A's lower triangle, the rest being zero.
template <class M, class K, class N>
void multiply_lower(M measured, K seen, N states, const Pack* h, const Pack* a, Pack* out) noexcept {
    const int m = measured, k = seen, n = states;
    for (int c = 0; c < k; ++c) {
        for (int r = 0; r < m; ++r) {
            Pack sum = h[c * m + r] * a[c * n + c];
            for (int i = c + 1; i < k; ++i) sum += h[i * m + r] * a[c * n + i];
            out[c * m + r] = sum;
        }
    }
}

template <class N, class M, class K>
void project_of(N states, M measured, K looked_at, const Projection& task) noexcept {
    const int n = states, m = measured, seen = looked_at;
    constexpr int most = most_states<N>, wide = most_measured<M>;
    for (Group group{task.outcome, task.items}; group.is_left(); group.next()) {
        Pack p[most + most * most], h[wide * most], cross[most * wide], projected[wide * wide];
        load_items(task.record, group, n + seen * n, p);
        load_items(task.jacobian, group, m * seen, h);
        for (int r = 0; r < m; ++r) {
            for (int i = 0; i < n; ++i) {
                Pack sum{};
                for (int k = 0; k < seen; ++k) sum += p[n + k * n + i] * h[k * m + r];
                cross[r * n + i] = sum;
            }
        }
        Pack check{};
        for (int c = 0; c < m; ++c) {
            for (int r = c; r < m; ++r) {
                Pack sum{};
                for (int k = 0; k < seen; ++k) sum += h[k * m + r] * cross[c * n + k];
                projected[c * m + r] = projected[r * m + c] = sum;
                check += 0.0 * sum;
            }
        }
        if (task.cross.first != nullptr)
            for (int e = 0; e < m * n; ++e) check += 0.0 * cross[e];
        note(group, ~(check == 0.0), Outcome::not_finite, task.outcome);
        store_items(projected, m * m, group, task.projected);
        if (task.cross.first != nullptr) store_items(cross, m * n, group, task.cross);
    }
    leave_lanes();
}

/// What an update works with: the factors of P, and of S and S^-1/2 times the innovation.
template <int most, int wide> struct Factors {
    Pack l[most * most],
        more[most * wide];         // of P; then the columns of K S^1/2 and of the updated P's, as reflect_update says
    Pack s[wide * (most + wide)];  // the first m columns
    Pack inverse[wide];            // of the diagonal of the factor of S
    Pack whitened[wide];
};

template <class N, class M, class K, class F>
void factorise(N states, M measured, K looked_at, const Update& task, const Group& group, const Pack* record,
               F& out) noexcept {
    const int n = states, m = measured, seen = looked_at;
    constexpr int most = most_states<N>, wide = most_measured<M>;
    // What does not wait for each other stands side by side: the processor looks some hundred instructions ahead.
    Mask indefinite{}, noise_indefinite{};
    Pack r[wide * wide], h[wide * most];
    load_items(task.noise, group, times(measured, measured), r);
    load_items(task.jacobian, group, times(measured, looked_at), h);
    Pack* const noise = out.s + seen * m;
    cholesky_semidefinite(measured, r, noise, noise_indefinite);
    cholesky_columns(states, 0, seen, record + states, out.l, indefinite);
    for (int c = 1; c < seen; ++c)
        for (int i = 0; i < c; ++i) out.l[c * n + i] = Pack{};
    multiply_lower(measured, looked_at, states, h, out.l, out.s);
    cholesky_columns(states, seen, states, record + states, out.l, indefinite);
    reflect_update(states, measured, looked_at, out.s, out.l, out.more);

    Pack check{};
    Mask singular{};
    for (int c = 0; c < m; ++c) {
        singular |= ~(out.s[c * m + c] > 0.0);
        out.inverse[c] = 1.0 / out.s[c * m + c];
        for (int i = c; i < m; ++i) check += 0.0 * out.s[c * m + i];
        for (int i = 0; i < c; ++i) out.s[c * m + i] = Pack{};
    }
    note(group, indefinite, Outcome::covariance_indefinite, task.outcome);
    note(group, noise_indefinite, Outcome::noise_indefinite, task.outcome);
    note(group, ~(check == 0.0), Outcome::not_finite, task.outcome);
    note(group, singular, Outcome::innovation_singular, task.outcome);
}

/// The record after the update: mean + K S^1/2 (S^-1/2 innovation), and the product of the columns that are left.
template <class N, class M, class K, class F>
void correct(N states, M measured, K looked_at, F& by, const Pack* from, Pack* out) noexcept {
    const int n = states, m = measured, seen = looked_at;
    const auto column = [&](int j) { return column_of_update(states, looked_at, by.l, by.more, j); };
    for (int i = 0; i < n; ++i) {
        Pack shift = column(0)[i] * by.whitened[0];
        for (int r = 1; r < m; ++r) shift += column(r)[i] * by.whitened[r];
        out[i] = from[i] + shift;
    }
    for (int j = 0; j < n; ++j) {
        for (int i = j; i < n; ++i) {
            Pack sum = column(m)[i] * column(m)[j];
            for (int c = m + 1; c < seen + m; ++c) sum += column(c)[i] * column(c)[j];
            for (int c = seen; c <= j; ++c) sum += by.l[c * n + i] * by.l[c * n + j];
            out[n + j * n + i] = out[n + i * n + j] = sum;
        }
    }
}

template <class N, class M, class K> void update_of(N states, M measured, K looked_at, const Update& task) noexcept {
    const int n = states, m = measured;
    constexpr int most = most_states<N>, wide = most_measured<M>;
    for (Group group{task.outcome, task.items}; group.is_left(); group.next()) {
        Pack from[most + most * most], out[most + most * most], innovation[wide];
        Factors<most, wide> factors;
        load_items(task.record, group, numbers_of_record(states), from);
        load_items(task.innovation, group, measured, innovation);
        factorise(states, measured, looked_at, task, group, from, factors);
        whiten(measured, factors.s, factors.inverse, innovation, factors.whitened);
        Pack log_likelihood{};
        if (task.log_likelihood.first != nullptr) log_likelihood = log_normal(measured, factors.s, factors.whitened);
        correct(states, measured, looked_at, factors, from, out);
        // No element of a covariance is larger than those of its diagonal.
        Pack check{};
        for (int i = 0; i < n; ++i) check += 0.0 * out[i] + 0.0 * out[n + i * n + i];
        note(group, ~(check == 0.0), Outcome::not_finite, task.outcome);
        store_items(out, numbers_of_record(states), group, task.out);
        if (task.log_likelihood.first != nullptr) store_items(&log_likelihood, Fixed<1>{}, group, task.log_likelihood);
        if (task.innovation_covariance.first != nullptr) {
            Pack s[wide * wide];
            gram(measured, measured, factors.s, s);
            store_items(s, m * m, group, task.innovation_covariance);
        }
    }
    leave_lanes();
}

// ------------------------------------------------------------------------------- the sizes that are compiled for

template <int B, int D> BlockKernel fixed_blocks() noexcept {
    return [](const BlockStep& step) {
        if (B == 2 && step.upper_triangular && step.is_common)
            predict_pairs<D>(step);
        else if (step.upper_triangular)
            predict_blocks_of<Fixed<B>, Fixed<D>, true>({}, {}, step);
        else
            predict_blocks_of<Fixed<B>, Fixed<D>, false>({}, {}, step);
    };
}

BlockKernel by_blocks(int b, int d) noexcept {
    if (b == 2 && d == 2) return fixed_blocks<2, 2>();
    if (b == 2 && d == 3) return fixed_blocks<2, 3>();
    if (b == 3 && d == 2) return fixed_blocks<3, 2>();
    if (b == 3 && d == 3) return fixed_blocks<3, 3>();
    return [](const BlockStep& step) { predict_blocks_of<int, int, false>(step.derivatives, step.axes, step); };
}

template <int N> FullKernel fixed_full() noexcept {
    return [](const FullStep& step) { predict_full_of(Fixed<N>{}, step); };
}

FullKernel full(int n) noexcept {
    if (n == 4) return fixed_full<4>();
    if (n == 6) return fixed_full<6>();
    if (n == 9) return fixed_full<9>();
    return [](const FullStep& step) { predict_full_of(step.states, step); };
}

template <int N, int M, int K> MeasurementKernels fixed_measurement() noexcept {
    return {[](const Update& task) { update_of(Fixed<N>{}, Fixed<M>{}, Fixed<K>{}, task); },
            [](const Projection& task) { project_of(Fixed<N>{}, Fixed<M>{}, Fixed<K>{}, task); }};
}

/// Sensors of two or three components that see two or three, or any, of N.
template <int N> MeasurementKernels measurement_of(int m, int seen) noexcept {
    if (m == 2 && seen == 2) return fixed_measurement<N, 2, 2>();
    if (m == 3 && seen == 3) return fixed_measurement<N, 3, 3>();
    if (m == 2)
        return {[](const Update& task) { update_of(Fixed<N>{}, Fixed<2>{}, task.seen, task); },
                [](const Projection& task) { project_of(Fixed<N>{}, Fixed<2>{}, task.seen, task); }};
    return {[](const Update& task) { update_of(Fixed<N>{}, task.measured, task.seen, task); },
            [](const Projection& task) { project_of(Fixed<N>{}, task.measured, task.seen, task); }};
}

MeasurementKernels measurement(int n, int m, int seen) noexcept {
    if (n == 4) return measurement_of<4>(m, seen);
    if (n == 6) return measurement_of<6>(m, seen);
    if (n == 9) return measurement_of<9>(m, seen);
    return {[](const Update& task) { update_of(task.states, task.measured, task.seen, task); },
            [](const Projection& task) { project_of(task.states, task.measured, task.seen, task); }};
}

}  // namespace

extern const Kernels kernels;
const Kernels kernels{&by_blocks, &full, &measurement};

}  // namespace PELORUS_LANES

}  // namespace kalman
