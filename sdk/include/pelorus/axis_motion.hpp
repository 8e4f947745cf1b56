/// Linear motions whose axes differ in nothing but the intensity of their noise: F = F1 (x) I, Q = Q1 (x) diag(intensity).
///
///     struct Mine : pelorus::AxisMotion<Mine, 2, 3> {              // position and velocity, three axes
///         Block transition(double dt) const;                       // F1
///         Block unit_noise(double dt) const;                       // Q1 for intensity 1
///         std::vector<double> priors() const;                      // a deviation for each derivative
///         void setup(const pelorus::Setup&) { intensity = pelorus::per_axis<3>("noise", noise); }
///     };
///
/// Where Q1 = g g' has rank one, `static constexpr bool rank_one = true` and `Vector<B> unit_factor(double dt) const` (that
/// g) offer the factor to square-root filters. The structure F1 (x) I, Q1 (x) I is offered where all intensities are equal.
#pragma once

#include <cmath>
#include <cstring>

#include <pelorus/motion.hpp>
#include <pelorus/per_axis.hpp>

namespace pelorus {

/// block (x) diag(weights): what acts on every axis alike, but for a weight. `block` is square, derivative by derivative.
template <int B, int D> Matrix<B * D> on_axes(const Matrix<B>& block, const Vector<D>& weights) {
    Matrix<B* D> full = Matrix<B * D>::Zero();
    for (int r = 0; r < B; ++r)
        for (int c = 0; c < B; ++c)
            for (int axis = 0; axis < D; ++axis) full(r * D + axis, c * D + axis) = block(r, c) * weights(axis);
    return full;
}

/// The same for a column: g (x) diag(weights), a column an axis.
template <int B, int D> Matrix<B * D, D> column_on_axes(const Vector<B>& g, const Vector<D>& weights) {
    Matrix<B * D, D> full = Matrix<B * D, D>::Zero();
    for (int r = 0; r < B; ++r)
        for (int axis = 0; axis < D; ++axis) full(r * D + axis, axis) = g(r) * weights(axis);
    return full;
}

namespace detail {

template <class Model, int Columns>
plr_status noise_factor_entry(const void* self, const plr_call* call, const plr_motion_noise* args) noexcept {
    return guarded(call->error, [&] {
        constexpr int n = Model::state_size;
        const auto& model = *static_cast<const Model*>(self);
        const std::int64_t count = args->out.count;
        expect(args->dt, 1, 1, count, "dt");
        if constexpr (Model::record_size > 0) expect(args->record, Model::record_size, 1, count, "record");
        if constexpr ((Model::flags & PLR_MOTION_CONSTANT_NOISE) == 0) {
            expect(args->state, n, 1, count, "state");
            expect(args->covariance, n, n, count, "covariance");
            expect(args->predicted, n, 1, count, "predicted");
        }
        expect(args->out, n, Columns, count, "out");
        return for_items(*call, count, [&](std::int64_t i) {
            const Step step = step_of(*call, args->dt, args->record, i);
            if ((Model::flags & PLR_MOTION_BACKWARD) == 0 && step.dt < 0)
                throw UnsupportedError("cannot move backward in time (dt < 0)");
            const Matrix<n, Columns> factor = model.noise_factor(posterior_of<Model>(*args, i), step);
            store<n, Columns>(args->out, i, factor);
        });
    });
}

}  // namespace detail

/// The extension PLR_MOTION_NOISE_FACTOR of a model that has a member
///     Matrix<N, Columns> noise_factor(const Posterior&, const Step&) const;      // G, with Q = G G'
template <class Model, int Columns> const plr_motion_noise_factor* noise_factor_extension() noexcept {
    static constexpr plr_motion_noise_factor factor{sizeof(plr_motion_noise_factor), Columns,
                                                    &detail::noise_factor_entry<Model, Columns>};
    return &factor;
}

/// B derivatives (position first), D axes.
template <class Derived, int B, int D> class AxisMotion : public KroneckerMotion<Derived, B, D> {
    using Base = KroneckerMotion<Derived, B, D>;

public:
    static constexpr bool rank_one = false;
    using typename Base::Block;
    using typename Base::Posterior;
    using typename Base::Transition;

    Vector<D> intensity =
        Vector<D>::Ones();  ///< variance or spectral density of the noise of each axis; set in setup()

    /// Q1 of the structure, which is offered for equal intensities only.
    Block noise_block(double dt) const { return this->derived().unit_noise(dt) * intensity(0); }

    Transition noise(const Posterior&, const Step& step) const {
        return on_axes<B, D>(this->derived().unit_noise(step.dt), intensity);
    }
    /// G = g (x) diag(sqrt(intensity)), of a rank-one model.
    Matrix<B * D, D> noise_factor(const Posterior&, const Step& step) const {
        const Vector<B> unit = this->derived().unit_factor(step.dt);
        return column_on_axes<B, D>(unit, Vector<D>(intensity.cwiseSqrt()));
    }

    const void* extension(const char* id) const noexcept {
        if (std::strcmp(id, PLR_MOTION_STRUCTURE) == 0 && intensity != Vector<D>::Constant(intensity(0)))
            return nullptr;
        if constexpr (Derived::rank_one)
            if (std::strcmp(id, PLR_MOTION_NOISE_FACTOR) == 0) return noise_factor_extension<Derived, D>();
        return Base::extension(id);
    }
};

/// Declares `prior_position` and `prior_velocity`, which all these models take.
template <class Plugin, class Parameters>
void describe_priors(Describe<Plugin>& plugin, double Parameters::*position, double Parameters::*velocity) {
    plugin.parameter("prior_position", position)
        .unit("m")
        .initially("1000 km")
        .above(0.0)
        .doc("deviation of a position component that nothing is known of, about 0");
    plugin.parameter("prior_velocity", velocity)
        .unit("m/s")
        .initially("100 m/s")
        .above(0.0)
        .doc("deviation of a velocity component that nothing is known of, about 0");
}

}  // namespace pelorus
