/// The class behind motion.ballistic, for each form of the state, of the integration and of the noise.
#pragma once

#include "../../common/axis_models/singer.hpp"
#include "../../common/ballistic/flight.hpp"
#include "../../common/ballistic/frame.hpp"
#include "../../common/kinematics/white_acceleration.hpp"

#include <optional>

#include <pelorus/axis_motion.hpp>

namespace ballistic {

enum class Drag { none, known, estimated };
enum class Integration { runge_kutta, held };

struct Parameters : FrameParameters {
    Drag drag = Drag::none;
    std::optional<double> drag_parameter, air_density, scale_height;  // m2/kg, kg/m3, m
    Integration integration = Integration::runge_kutta;
    std::optional<double> maximum_step;                                    // s
    std::optional<double> maneuver_rate;                                   // 1/s
    std::optional<double> density, deviation, over_extent;                 // m2/s3, m/s2, 1/s2
    std::optional<double> drag_noise, prior_log_drag, prior_acceleration;  // 1/s, 1, m/s2
    double prior_position = 0.0, prior_velocity = 0.0;

    /// Of the acceleration that is constant over the step or, with `maneuver_rate`, in the long run (m/s2).
    double acceleration_deviation() const noexcept { return deviation.value_or(1.0); }
};

/// Throws ParameterError for values that do not go with each other.
inline void check(const Parameters& p) {
    if (p.drag == Drag::none) {
        constexpr const char* reason = "belongs to drag: known and drag: estimated";
        refuse(p.drag_parameter.has_value(), "drag_parameter", reason);
        refuse(p.air_density.has_value(), "air_density", reason);
        refuse(p.scale_height.has_value(), "scale_height", reason);
    }
    if (p.drag == Drag::estimated) {
        refuse(p.integration == Integration::held, "integration",
               "held does not tell how the flight changes with drag; drag: estimated needs runge_kutta");
        refuse(p.maneuver_rate.has_value(), "maneuver_rate",
               "goes with drag: none and drag: known; an acceleration and drag cannot be told apart");
    } else {
        refuse(p.drag_noise.has_value(), "drag_noise", "belongs to drag: estimated");
        refuse(p.prior_log_drag.has_value(), "prior_log_drag", "belongs to drag: estimated");
    }
    refuse(p.integration == Integration::held && p.maximum_step, "maximum_step",
           "belongs to integration: runge_kutta; held takes one step, however long");
    refuse(p.density && p.deviation, "acceleration", "noise is given; the disturbance is the one or the other");
    if (p.maneuver_rate) {
        refuse(p.density.has_value(), "noise", "does not go with maneuver_rate, whose disturbance is acceleration");
        refuse(p.over_extent && p.deviation, "noise_over_extent",
               "acceleration is given; the disturbance is the one or the other");
    } else {
        refuse(p.over_extent.has_value(), "noise_over_extent", "belongs to maneuver_rate");
        refuse(p.prior_acceleration.has_value(), "prior_acceleration", "belongs to maneuver_rate");
    }
}

/// The forces by these parameters. Throws ParameterError.
inline Flight flight_of(const Parameters& p) {
    Flight flight;
    flight.earth = earth_of(p);
    flight.flat = p.axes == Axes::flat;
    flight.maximum_step = p.maximum_step.value_or(1.0);
    flight.maneuver_rate = p.maneuver_rate.value_or(0.0);
    if (p.drag != Drag::none) {
        flight.drag_parameter = p.drag_parameter.value_or(1e-4);
        flight.air_density = p.air_density.value_or(1.225);
        flight.scale_height = p.scale_height.value_or(7200.0);
    }
    return flight;
}

/// Behind position and velocity stands an acceleration where it manoeuvres, or the drag parameter's logarithm where that is estimated.
template <Drag drag_, bool manoeuvres>
inline constexpr int state_size = manoeuvres                 ? 9
                                  : drag_ == Drag::estimated ? 7
                                                             : 6;

template <Drag drag_, bool manoeuvres, Integration integration_, bool over_extent_>
struct Model : pelorus::Motion<Model<drag_, manoeuvres, integration_, over_extent_>, state_size<drag_, manoeuvres>>,
               Parameters {
    static constexpr int size = state_size<drag_, manoeuvres>, blocks = manoeuvres ? 3 : 2;
    static constexpr bool held = integration_ == Integration::held;
    using Base = pelorus::Motion<Model, size>;
    using typename Base::Posterior;
    using typename Base::State;
    using typename Base::Transition;
    using Block = Matrix<blocks>;
    // Under drag a long step and two short ones agree within the error of the integration only, and a force that is held makes no
    // flight that could be cut or gone back.
    static constexpr std::uint32_t flags =
        (over_extent_ ? PLR_MOTION_USES_EXTENT : PLR_MOTION_CONSTANT_NOISE) |
        (held ? 0u : std::uint32_t{PLR_MOTION_BACKWARD}) |
        (!held && drag_ == Drag::none ? std::uint32_t{PLR_MOTION_TIME_INVARIANT} : 0u);

    Flight flight;

    static void describe(pelorus::Describe<Model>& plugin);

    void setup(const pelorus::Setup&) {
        check(*this);
        flight = flight_of(*this);
        if (manoeuvres && !prior_acceleration) prior_acceleration = acceleration_deviation();
        if (manoeuvres && !(*prior_acceleration > 0.0))
            throw pelorus::ParameterError("prior_acceleration", "is needed where acceleration is 0");
    }

    pelorus::Space space() const {
        if (manoeuvres) return pelorus::kinematic_space(3, {prior_position, prior_velocity, *prior_acceleration});
        std::vector<pelorus::Component> components =
            pelorus::kinematic_space(3, {prior_position, prior_velocity}).components();
        if (size == 7) components.push_back({"log_drag", "", 0.0, prior_log_drag.value_or(0.5), false});
        return components;
    }
    State propagate(const State& x, const pelorus::Step& step) const {
        if constexpr (held) {
            // Points that are spread about a mean all feel the force that is felt there.
            const double* const mean = step.mean == nullptr ? x.data() : step.mean;
            const Vector<3> a =
                flight.acceleration(Eigen::Map<const Vector<3>>(mean), Eigen::Map<const Vector<3>>(mean + 3), step.dt);
            State out = on_each_axis(unforced(step.dt), x);
            out.template head<3>() += step.dt * step.dt / 2.0 * a;
            out.template segment<3>(3) += step.dt * a;
            return out;
        } else {
            return flight.propagate<size>(x, step.dt);
        }
    }
    Transition jacobian(const State& x, const pelorus::Step& step) const {
        if constexpr (held)
            return pelorus::on_axes<blocks, 3>(unforced(step.dt), Vector<3>::Ones());
        else
            return flight.jacobian<size>(x, step.dt);
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        Transition q = Transition::Zero();
        const Block unit = unit_noise(step.dt);
        if constexpr (over_extent_) {
            const Matrix<3> extent = *over_extent * *over_extent * Eigen::Map<const Matrix<3>>(posterior.extent);
            for (int row = 0; row < blocks; ++row)
                for (int col = 0; col < blocks; ++col)
                    q.template block<3, 3>(3 * row, 3 * col) = unit(row, col) * extent;
        } else {
            const bool white = !manoeuvres && !deviation;
            const double intensity =
                white ? density.value_or(0.01) : acceleration_deviation() * acceleration_deviation();
            kinematics::add_per_axis(unit, Vector<3>(Vector<3>::Constant(intensity)), q);
        }
        if (size == 7) q(size - 1, size - 1) = drag_noise.value_or(1e-4) * std::fabs(step.dt);
        return q;
    }

private:
    /// F of one axis without forces.
    Block unforced(double dt) const {
        if constexpr (manoeuvres) {
            return singer::exact_transition(*maneuver_rate, dt);
        } else {
            Block f;
            f << 1.0, dt, 0.0, 1.0;
            return f;
        }
    }
    /// Q of one axis for a unit of what disturbs it.
    Block unit_noise(double dt) const {
        if constexpr (manoeuvres) {
            return singer::exact_noise(*maneuver_rate, dt);
        } else {
            if (!deviation) return kinematics::white_acceleration(dt);
            const Vector<2> g = kinematics::steady_acceleration(dt);
            return g * g.transpose();
        }
    }
    static State on_each_axis(const Block& f, const State& x) {
        State out = State::Zero();
        for (int row = 0; row < blocks; ++row)
            for (int col = 0; col < blocks; ++col)
                for (int axis = 0; axis < 3; ++axis) out(3 * row + axis) += f(row, col) * x(3 * col + axis);
        return out;
    }
};

/// Makes the form with `maneuver_rate` that these parameters choose.
plr_instance manoeuvring(const Parameters& chosen, const pelorus::Setup& setup);

}  // namespace ballistic
