// Kernels over lanes for measurements: what is expected, and what is learned. Includes nothing that has inline functions of its
// own: see plugins/common/lanes/pack.hpp.
#include "factor_kernels.hpp"
#include "groups.hpp"

namespace gaussian {

inline namespace PELORUS_LANES {

namespace {

using namespace lanes;

/// An image of m rows, as another kernel has left it.
template <class N, class M> struct Looks {
    Pack slope[most_measured<M> * most_states<N>];
    Pack residual[most_measured<M> * (max_state + 1)];
    Pack downdate[most_measured<M>];

    Looks(N states, M measured, const Image& image, const Group& group) noexcept {
        const int n = states, m = measured;
        const double* const kept = beside(image.kept, group, image_doubles(m, n));
        recall(kept, m * image.seen, slope);
        recall(kept + m * n * width, m * image.columns, residual);
        if (image.has_downdate) recall(kept + m * (n + residual_columns(m, n)) * width, m, downdate);
    }
};

template <class N, class M> void project_of(N states, M measured, const FactorProjection& task) noexcept {
    const int n = states, m = measured, seen = task.image.seen;
    constexpr int most = most_states<N>, wide = most_measured<M>;
    for (Group group{task.outcome, task.items}; group.is_left(); group.next()) {
        const Looks<N, M> looks(states, measured, task.image, group);
        Pack factor[most * most], projected[wide * wide], cross[most * wide];
        recall(beside(task.factors, group, n * n), n * n, factor);
        for (int c = 0; c < m; ++c) {
            for (int r = c; r < m; ++r) {
                Pack sum{};
                for (int k = 0; k < seen; ++k) sum += looks.slope[k * m + r] * looks.slope[k * m + c];
                for (int k = 0; k < task.image.columns; ++k)
                    sum += looks.residual[k * m + r] * looks.residual[k * m + c];
                if (task.image.has_downdate) sum -= looks.downdate[r] * looks.downdate[c];
                projected[c * m + r] = projected[r * m + c] = sum;
            }
        }
        Pack check = check_finite(m * m, projected) + check_finite(n * n, factor);
        if (task.cross.first != nullptr) {
            for (int r = 0; r < m; ++r) {
                for (int i = 0; i < n; ++i) {
                    Pack sum{};
                    for (int k = 0; k < seen; ++k) sum += factor[k * n + i] * looks.slope[k * m + r];
                    cross[r * n + i] = sum;
                }
            }
            check += check_finite(n * m, cross);
        }
        note(group, ~(check == 0.0), Outcome::not_finite, task.outcome);
        store_items(projected, m * m, group, task.projected);
        if (task.cross.first != nullptr) store_items(cross, n * m, group, task.cross);
    }
    leave_lanes();
}

/// The factor of what the state does not explain: the triangle of [N E], less u u'; N N' = R.
template <class N, class M>
void join_noise(M measured, const FactorUpdate& task, const Group& group, Looks<N, M>& looks, Pack* out) noexcept {
    const int m = measured;
    Mask indefinite{};
    load_items(task.noise, group, m * m, out);
    cholesky_semidefinite(measured, out, out, indefinite);
    note(group, indefinite, Outcome::noise_indefinite, task.outcome);
    clear_above_diagonal(measured, out);
    append_columns(measured, task.image.columns, out, looks.residual);
    if (!task.image.has_downdate) return;
    Pack scratch[most_measured<M>];
    indefinite = Mask{};
    downdate(measured, out, looks.downdate, scratch, indefinite);
    note(group, indefinite, Outcome::regression_indefinite, task.outcome);
}

/// What an update tells besides the record, and the innovation in units of its deviations.
template <class M>
void tell(M measured, const FactorUpdate& task, const Group& group, const Pack* z, Pack* white) noexcept {
    const int m = measured;
    constexpr int wide = most_measured<M>;
    Pack inverse[wide], innovation[room(wide)];
    Pack check{};
    Mask singular{};
    for (int c = 0; c < m; ++c) {
        singular |= ~(z[c * m + c] > 0.0);
        inverse[c] = 1.0 / z[c * m + c];
        for (int i = c; i < m; ++i) check += 0.0 * z[c * m + i];
    }
    note(group, ~(check == 0.0), Outcome::not_finite, task.outcome);
    note(group, singular, Outcome::innovation_singular, task.outcome);
    load_items(task.innovation, group, measured, innovation);
    const Pack told = log_normal(measured, z, inverse, innovation, white);
    if (task.log_likelihood.first != nullptr) store_items(&told, Fixed<1>{}, group, task.log_likelihood);
    if (task.innovation_covariance.first != nullptr) {
        Pack s[wide * wide];
        gram(measured, measured, z, s);
        store_items(s, m * m, group, task.innovation_covariance);
    }
}

template <class N, class M> void update_of(N states, M measured, const FactorUpdate& task) noexcept {
    const int n = states, m = measured;
    constexpr int most = most_states<N>, wide = most_measured<M>;
    for (Group group{task.outcome, task.items}; group.is_left(); group.next()) {
        Looks<N, M> looks(states, measured, task.image, group);
        Pack factor[most * most], z[wide * wide], gain[most * wide], white[wide], scratch[max_state + 1];
        Pack out[most + most * most];
        recall(beside(task.factors, group, n * n), n * n, factor);
        load_items(task.record, group, states, out);
        join_noise(measured, task, group, looks, z);
        array_update(states, measured, task.image.seen, factor, z, looks.slope, gain, scratch);
        tell(measured, task, group, z, white);
        for (int c = 0; c < m; ++c)
            for (int r = 0; r < n; ++r) out[r] += gain[c * n + r] * white[c];
        if (task.is_root) {
            if (task.is_reordered) {
                triangularise_rows(states, states, factor);
                clear_above_diagonal(states, factor);
            }
            for (int e = 0; e < n * n; ++e) out[n + e] = factor[e];
        } else {
            gram(states, states, factor, out + n);
        }
        note(group, ~(check_finite(n + n * n, out) == 0.0), Outcome::not_finite, task.outcome);
        store_items(out, n + n * n, group, task.out);
    }
    leave_lanes();
}

template <class N, class M> LookKernels fixed_look() noexcept {
    return {[](const FactorUpdate& task) { update_of(N{}, M{}, task); },
            [](const FactorProjection& task) { project_of(N{}, M{}, task); }};
}

template <class N> LookKernels look_of(int m) noexcept {
    if (m == 2) return fixed_look<N, Fixed<2>>();
    if (m == 3) return fixed_look<N, Fixed<3>>();
    return {[](const FactorUpdate& task) { update_of(N{}, task.measured, task); },
            [](const FactorProjection& task) { project_of(N{}, task.measured, task); }};
}

}  // namespace

LookKernels look(int states, int measured) noexcept;
LookKernels look(int states, int measured) noexcept {
    if (states == 4) return look_of<Fixed<4>>(measured);
    if (states == 6) return look_of<Fixed<6>>(measured);
    if (states == 9) return look_of<Fixed<9>>(measured);
    return {[](const FactorUpdate& task) { update_of(task.states, task.measured, task); },
            [](const FactorProjection& task) { project_of(task.states, task.measured, task); }};
}

}  // namespace PELORUS_LANES

}  // namespace gaussian
