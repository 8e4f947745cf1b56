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
        const Block unit = this->derived().unit_noise(step.dt);
        Transition full = Transition::Zero();
        for (int r = 0; r < B; ++r)
            for (int c = 0; c < B; ++c)
                for (int axis = 0; axis < D; ++axis) full(r * D + axis, c * D + axis) = unit(r, c) * intensity(axis);
        return full;
    }

    const void* extension(const char* id) const noexcept {
        if (std::strcmp(id, PLR_MOTION_STRUCTURE) == 0 && intensity != Vector<D>::Constant(intensity(0)))
            return nullptr;
        if constexpr (Derived::rank_one) {
            static constexpr plr_motion_noise_factor factor{sizeof(plr_motion_noise_factor), D, &factor_entry};
            if (std::strcmp(id, PLR_MOTION_NOISE_FACTOR) == 0) return &factor;
        }
        return Base::extension(id);
    }

private:
    /// G = g (x) diag(sqrt(intensity)).
    static plr_status factor_entry(const void* self, const plr_call* call, const plr_motion_noise* args) noexcept {
        return guarded(call->error, [&] {
            const auto& model = *static_cast<const Derived*>(self);
            const std::int64_t count = args->out.count;
            expect(args->dt, 1, 1, count, "dt");
            expect(args->out, B * D, D, count, "out");
            return for_items(*call, count, [&](std::int64_t i) {
                const double dt = args->dt.data[i * args->dt.item_stride];
                if ((Derived::flags & PLR_MOTION_BACKWARD) == 0 && dt < 0)
                    throw UnsupportedError("cannot move backward in time (dt < 0)");
                const Vector<B> unit = model.unit_factor(dt);
                Matrix<B * D, D> full = Matrix<B * D, D>::Zero();
                for (int r = 0; r < B; ++r)
                    for (int axis = 0; axis < D; ++axis)
                        full(r * D + axis, axis) = unit(r) * std::sqrt(model.intensity(axis));
                store<B * D, D>(args->out, i, full);
            });
        });
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
