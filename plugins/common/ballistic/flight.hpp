/// Free flight under gravity and drag, and manoeuvres about it, integrated by the classical Runge-Kutta method of fourth order, with its
/// Jacobian.
#pragma once

#include "air.hpp"

#include <cstdint>

#include <pelorus/failure.hpp>

namespace ballistic {

/// All forces. Immutable once set up.
struct Flight {
    Earth earth;
    bool flat = true;             ///< height is z, not that above the spheroid
    double drag_parameter = 0.0;  ///< m2/kg, 0: no air
    double air_density = 0.0;     ///< kg/m3, at height 0
    double scale_height = 1.0;    ///< m
    double maximum_step = 1.0;    ///< s
    double maneuver_rate = 0.0;   ///< 1/s, at which an acceleration beyond these forces fades

    static constexpr std::int64_t most_steps = 100000;

    /// By all forces, at a position and a velocity (m/s2). Throws NumericError where drag would take the whole speed within a step h.
    Vector<3> acceleration(const Vector<3>& position, const Vector<3>& velocity, double h) const {
        return acceleration(position, velocity, drag_parameter, h);
    }

    /// N = 6: position and velocity; N = 7: and the logarithm of the drag parameter over `drag_parameter`; N = 9: and an acceleration
    /// beyond the forces.
    template <int N> Vector<N> propagate(const Vector<N>& x, double dt) const {
        const std::int64_t steps = steps_for(dt);
        const double h = steps == 0 ? 0.0 : dt / static_cast<double>(steps);
        Vector<N> y = x;
        for (std::int64_t k = 0; k < steps; ++k) {
            const Vector<N> k1 = rate(y, h), k2 = rate<N>(y + h / 2.0 * k1, h), k3 = rate<N>(y + h / 2.0 * k2, h),
                            k4 = rate<N>(y + h * k3, h);
            y += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
        }
        return y;
    }

    /// d propagate / d x: the derivative of the very steps that propagate takes, by the variational equations along them.
    template <int N> Matrix<N> jacobian(const Vector<N>& x, double dt) const {
        const std::int64_t steps = steps_for(dt);
        const double h = steps == 0 ? 0.0 : dt / static_cast<double>(steps);
        Variation<N> y{x, Matrix<N>::Identity()};
        for (std::int64_t k = 0; k < steps; ++k) {
            const Variation<N> k1 = rate(y, h), k2 = rate(y.moved(h / 2.0, k1), h), k3 = rate(y.moved(h / 2.0, k2), h),
                               k4 = rate(y.moved(h, k3), h);
            y.state += h / 6.0 * (k1.state + 2.0 * (k2.state + k3.state) + k4.state);
            y.matrix += h / 6.0 * (k1.matrix + 2.0 * (k2.matrix + k3.matrix) + k4.matrix);
        }
        return y.matrix;
    }

private:
    /// A state and d state / d start, or the rates of both.
    template <int N> struct Variation {
        Vector<N> state;
        Matrix<N> matrix;
        Variation moved(double h, const Variation& rate) const {
            return {state + h * rate.state, matrix + h * rate.matrix};
        }
    };

    std::int64_t steps_for(double dt) const {
        // At a twentieth of a time constant a step, what is left of a manoeuvre is off by 5e-8 a time constant.
        const double longest = maneuver_rate * maximum_step > 0.05 ? 0.05 / maneuver_rate : maximum_step;
        const double wanted = std::ceil(std::fabs(dt) / longest);
        if (!(wanted <= static_cast<double>(most_steps)))
            throw pelorus::NumericError("dt is more than " + std::to_string(most_steps) +
                                        " times maximum_step: make maximum_step longer");
        return static_cast<std::int64_t>(wanted);
    }
    Height height(const Vector<3>& position) const {
        return flat ? Height{position(2), Vector<3>::UnitZ()} : height_of(earth, position);
    }
    template <int N> double drag_of(const Vector<N>& x) const {
        if constexpr (N == 7) return drag_parameter * std::exp(x(6));
        return drag_parameter;
    }
    /// The method is not stable, nor anything like the motion, where drag would take the whole speed within a step.
    static void check_drag(const Vector<3>& drag, const Vector<3>& velocity, double h) {
        if (!(drag.norm() * std::fabs(h) <= velocity.norm()))
            throw pelorus::NumericError("drag would take the whole speed within maximum_step: make it shorter");
    }

    Vector<3> acceleration(const Vector<3>& position, const Vector<3>& velocity, double drag_now, double h) const {
        const Vector<3> a = earth.acceleration(position, velocity);
        if (!(drag_parameter > 0.0)) return a;
        const Density density = density_at(height(position).value, air_density, scale_height);
        const Vector<3> d = drag(density.value, drag_now, velocity);
        check_drag(d, velocity, h);
        return a + d;
    }

    template <int N> Vector<N> rate(const Vector<N>& x, double h) const {
        Vector<N> out = Vector<N>::Zero();
        out.template head<3>() = x.template segment<3>(3);
        out.template segment<3>(3) = acceleration(x.template head<3>(), x.template segment<3>(3), drag_of(x), h);
        if constexpr (N == 9) {
            out.template segment<3>(3) += x.template tail<3>();
            out.template tail<3>() = -maneuver_rate * x.template tail<3>();
        }
        return out;
    }
    template <int N> Variation<N> rate(const Variation<N>& at, double h) const {
        const Vector<3> position = at.state.template head<3>(), velocity = at.state.template segment<3>(3);
        Acceleration a = earth.with_gradient(position, velocity);
        Vector<3> d = Vector<3>::Zero();
        if (drag_parameter > 0.0) {
            const Height above = height(position);
            const Acceleration air = drag_with_gradient(density_at(above.value, air_density, scale_height), above,
                                                        drag_of(at.state), velocity);
            d = air.value;
            check_drag(d, velocity, h);
            a.value += d;
            a.by_position += air.by_position;
            a.by_velocity += air.by_velocity;
        }
        Variation<N> out{Vector<N>::Zero(), Matrix<N>::Zero()};
        out.state.template head<3>() = velocity;
        out.state.template segment<3>(3) = a.value;
        if constexpr (N == 9) {
            out.state.template segment<3>(3) += at.state.template tail<3>();
            out.state.template tail<3>() = -maneuver_rate * at.state.template tail<3>();
            out.matrix.template bottomRows<3>() = -maneuver_rate * at.matrix.template bottomRows<3>();
        }
        for (int c = 0; c < N; ++c) {
            const Vector<3> dp = at.matrix.template block<3, 1>(0, c), dv = at.matrix.template block<3, 1>(3, c);
            out.matrix.template block<3, 1>(0, c) = dv;
            Vector<3> da = a.by_position * dp + a.by_velocity * dv;
            if constexpr (N == 7) da += d * at.matrix(6, c);
            if constexpr (N == 9) da += at.matrix.template block<3, 1>(6, c);
            out.matrix.template block<3, 1>(3, c) = da;
        }
        return out;
    }
};

}  // namespace ballistic
