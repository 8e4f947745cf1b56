/// Singer's model about a mean acceleration that is not 0 but comes from the last estimate (the current statistical model), on each
/// axis:
///     mean        x- = F x + (g - f) b,   F = Singer's with rate alpha, f its last column, g = [T^2/2; T; 1]
///     covariance  F P F' + s^2 Q1,        Q1 = Singer's exact noise for unit stationary variance
/// b, alpha and s^2 are the derived model's. With b the acceleration of x itself the mean moves as by a constant acceleration.
/// Source: H. R. Zhou, K. S. P. Kumar, A "current" statistical model and adaptive algorithm for estimating maneuvering targets,
/// Journal of Guidance, Control and Dynamics 7(5), 596-602, 1984.
#pragma once

#include <array>

#include "acceleration_model.hpp"
#include "singer.hpp"

namespace axis_models {

/// What a model says of one axis for one step.
struct CurrentStatistics {
    double mean_acceleration = 0.0;  ///< b, m/s2
    double maneuver_rate = 0.0;      ///< alpha, 1/s
    double variance = 0.0;           ///< s^2, m2/s4
};

/// Derived has `CurrentStatistics statistics(double acceleration, int axis, const Step&) const`, of the posterior mean's
/// acceleration; d propagate / d x holds that mean fixed, as sigma points about it do.
template <class Derived, int D> struct CurrentStatisticalMotion : pelorus::Motion<Derived, 3 * D> {
    using Base = pelorus::Motion<Derived, 3 * D>;
    using typename Base::Posterior;
    using typename Base::State;
    using typename Base::Transition;

    pelorus::Space space() const { return pelorus::kinematic_space(D, this->derived().priors()); }

    State propagate(const State& x, const pelorus::Step& step) const { return moved(step_about(x, step), x); }
    Transition jacobian(const State& x, const pelorus::Step& step) const {
        const double* const mean = step.mean == nullptr ? x.data() : step.mean;
        return by_axis([&](int axis) {
            const CurrentStatistics now = this->derived().statistics(mean[2 * D + axis], axis, step);
            return singer::exact_transition(now.maneuver_rate, step.dt);
        });
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        return by_axis([&](int axis) -> Matrix<3> {
            const CurrentStatistics now = this->derived().statistics(posterior.mean(2 * D + axis), axis, step);
            return now.variance * singer::exact_noise(now.maneuver_rate, step.dt);
        });
    }

    /// The table of all motions, but for a propagate that works out the step once for all points of an item.
    static const plr_motion& table() noexcept {
        static const plr_motion t = [] {
            plr_motion all = Base::table();
            all.propagate = &points_entry;
            return all;
        }();
        return t;
    }

private:
    /// x- = F x + shift on each axis.
    struct AxisStep {
        Matrix<3> f;
        Vector<3> shift;
    };
    using AxisSteps = std::array<AxisStep, D>;

    /// The step from a state that is the mean itself, unless `step` names another.
    AxisSteps step_about(const State& x, const pelorus::Step& step) const {
        const double* const mean = step.mean == nullptr ? x.data() : step.mean;
        const Vector<3> constant(step.dt * step.dt / 2.0, step.dt, 1.0);
        AxisSteps steps;
        for (int axis = 0; axis < D; ++axis) {
            const CurrentStatistics now = this->derived().statistics(mean[2 * D + axis], axis, step);
            AxisStep& own = steps[static_cast<std::size_t>(axis)];
            own.f = singer::exact_transition(now.maneuver_rate, step.dt);
            own.shift = (constant - own.f.col(2)) * now.mean_acceleration;
        }
        return steps;
    }
    static State moved(const AxisSteps& steps, const State& x) {
        State out;
        for (int axis = 0; axis < D; ++axis) {
            const AxisStep& own = steps[static_cast<std::size_t>(axis)];
            for (int r = 0; r < 3; ++r)
                out(r * D + axis) =
                    own.f(r, 0) * x(axis) + own.f(r, 1) * x(D + axis) + own.f(r, 2) * x(2 * D + axis) + own.shift(r);
        }
        return out;
    }
    static plr_status points_entry(const void* self, const plr_call* call, const plr_motion_propagate* args) noexcept {
        // Without a mean each point is its own (there is one); and what is ill formed is refused there.
        if (args->mean.data == nullptr || args->out.cols < 2) return Base::table().propagate(self, call, args);
        return pelorus::guarded(call->error, [&] {
            constexpr int n = 3 * D;
            const auto& model = *static_cast<const Derived*>(self);
            const std::int64_t count = args->out.count, points = args->out.cols;
            pelorus::expect(args->dt, 1, 1, count, "dt");
            pelorus::expect(args->state, n, points, count, "state");
            if constexpr (Derived::record_size > 0)
                pelorus::expect(args->record, Derived::record_size, 1, count, "record");
            pelorus::expect(args->out, n, points, count, "out");
            pelorus::expect(args->mean, n, 1, count, "mean");
            return pelorus::for_items(*call, count, [&](std::int64_t i) {
                const pelorus::Step step = pelorus::detail::step_of(*call, args->dt, args->record, i);
                if (step.dt < 0) throw pelorus::UnsupportedError("cannot move backward in time (dt < 0)");
                const AxisSteps steps = model.step_about(pelorus::load<n, 1>(args->mean, i), step);
                for (std::int64_t p = 0; p < points; ++p)
                    pelorus::store<n, 1>(args->out, i, moved(steps, pelorus::load_column<n>(args->state, i, p)), p);
            });
        });
    }
    /// The matrix whose small matrix on each axis is block(axis).
    template <class Block> static Transition by_axis(Block&& block) {
        Transition full = Transition::Zero();
        for (int axis = 0; axis < D; ++axis) {
            const Matrix<3> own = block(axis);
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) full(r * D + axis, c * D + axis) = own(r, c);
        }
        return full;
    }
};

}  // namespace axis_models
