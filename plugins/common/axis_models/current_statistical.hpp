/// Singer's model about a mean acceleration that is not 0 but comes from the last estimate (the current statistical model), on each
/// axis:
///     mean        x- = F x + (g - f) b,   F = Singer's with rate alpha, f its last column, g = [T^2/2; T; 1]
///     covariance  F P F' + s^2 Q1,        Q1 = Singer's exact noise for unit stationary variance
/// b, alpha and s^2 are the derived model's. With b the acceleration of x itself the mean moves as by a constant acceleration.
/// Source: H. R. Zhou, K. S. P. Kumar, A "current" statistical model and adaptive algorithm for estimating maneuvering targets,
/// Journal of Guidance, Control and Dynamics 7(5), 596-602, 1984.
#pragma once

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

    State propagate(const State& x, const pelorus::Step& step) const {
        const double* const mean = step.mean == nullptr ? x.data() : step.mean;
        const double dt = step.dt;
        State out;
        for (int axis = 0; axis < D; ++axis) {
            const CurrentStatistics now = this->derived().statistics(mean[2 * D + axis], axis, step);
            const Matrix<3> f = singer::exact_transition(now.maneuver_rate, dt);
            const Vector<3> own(x(axis), x(D + axis), x(2 * D + axis));
            const Vector<3> constant(dt * dt / 2.0, dt, 1.0);
            const Vector<3> after = f * own + (constant - f.col(2)) * now.mean_acceleration;
            for (int r = 0; r < 3; ++r) out(r * D + axis) = after(r);
        }
        return out;
    }
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

private:
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
