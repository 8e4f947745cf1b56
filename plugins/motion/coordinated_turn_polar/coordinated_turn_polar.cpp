// motion.coordinated_turn_polar: a turn in the plane, by speed, heading and turn rate. See README.md.
#include "../../common/kinematics/sinc.hpp"
#include "../../common/kinematics/white_acceleration.hpp"

#include <pelorus/axis_motion.hpp>
#include <pelorus/sensor.hpp>

namespace {

constexpr double unknown_heading = 1.8137993642342178;  // pi / sqrt(3): the deviation of an angle that may be any

/// State (position.x, position.y, speed, heading, turn rate), Cartesian (positions, velocities, turn rate).
struct CoordinatedTurnPolar : pelorus::Motion<CoordinatedTurnPolar, 5> {
    static constexpr std::uint32_t flags = PLR_MOTION_TIME_INVARIANT | PLR_MOTION_BACKWARD;
    static constexpr bool cartesian = false;

    double density = 0.0, rate_density = 0.0;  // m2/s3, rad2/s3
    double prior_position = 0.0, prior_velocity = 0.0, prior_turn_rate = 0.0;

    static void describe(pelorus::Describe<CoordinatedTurnPolar>& plugin);

    pelorus::Space space() const {
        return pelorus::Space({{"position.x", "m", 0.0, prior_position, false},
                               {"position.y", "m", 0.0, prior_position, false},
                               {"speed", "m/s", 0.0, prior_velocity, false},
                               {"heading", "rad", 0.0, unknown_heading, true},
                               {"turn_rate", "rad/s", 0.0, prior_turn_rate, false}});
    }
    pelorus::Space cartesian_space() const {
        std::vector<pelorus::Component> components =
            pelorus::kinematic_space(2, {prior_position, prior_velocity}).components();
        components.push_back({"turn_rate", "rad/s", 0.0, prior_turn_rate, false});
        return components;
    }

    /// Along the chord of the arc, whose direction is the heading in the middle of the turn.
    State propagate(const State& x, const pelorus::Step& step) const {
        const double half = x(4) * step.dt / 2.0, chord = x(2) * step.dt * kinematics::sinc(half);
        State y = x;
        y(0) += chord * std::cos(x(3) + half);
        y(1) += chord * std::sin(x(3) + half);
        y(3) = pelorus::wrap_angle(x(3) + 2.0 * half);
        return y;
    }
    Transition jacobian(const State& x, const pelorus::Step& step) const {
        const double dt = step.dt, half = x(4) * dt / 2.0, ratio = kinematics::sinc(half);
        const double chord = x(2) * dt * ratio, longer = x(2) * dt * half * kinematics::sinc_slope_ratio(half);
        const double cosine = std::cos(x(3) + half), sine = std::sin(x(3) + half);
        Transition f = Transition::Identity();
        f(0, 2) = dt * ratio * cosine;
        f(1, 2) = dt * ratio * sine;
        f(0, 3) = -chord * sine;
        f(1, 3) = chord * cosine;
        f(0, 4) = dt / 2.0 * (longer * cosine - chord * sine);
        f(1, 4) = dt / 2.0 * (longer * sine + chord * cosine);
        f(3, 4) = dt;
        return f;
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        const State& x = posterior.mean;
        const Transition q = forward_noise(x(2), x(3) + x(4) * step.dt / 2.0, std::fabs(step.dt));
        return step.dt < 0 ? kinematics::carried_back<5>(jacobian(x, step), q) : q;
    }

    Cartesian to_cartesian(const State& x) const {
        return {x(0), x(1), x(2) * std::cos(x(3)), x(2) * std::sin(x(3)), x(4)};
    }
    pelorus::Matrix<5> to_cartesian_jacobian(const State& x) const {
        const double cosine = std::cos(x(3)), sine = std::sin(x(3));
        pelorus::Matrix<5> j = pelorus::Matrix<5>::Identity();
        j.block<2, 2>(2, 2) << cosine, -x(2) * sine, sine, x(2) * cosine;
        return j;
    }
    State from_cartesian(const Cartesian& c) const {
        return {c(0), c(1), std::hypot(c(2), c(3)), std::atan2(c(3), c(2)), c(4)};
    }
    /// At rest no velocity tells of the heading: its row is 0, and estimators take the prior's deviation for it.
    pelorus::Matrix<5> from_cartesian_jacobian(const Cartesian& c) const {
        const double speed = std::hypot(c(2), c(3)), heading = std::atan2(c(3), c(2));
        const double cosine = std::cos(heading), sine = std::sin(heading), nearness = speed > 0.0 ? 1.0 / speed : 0.0;
        pelorus::Matrix<5> j = pelorus::Matrix<5>::Identity();
        j.block<2, 2>(2, 2) << cosine, sine, -sine * nearness, cosine * nearness;
        return j;
    }

private:
    /// Disturbed along the direction of the chord as by a white acceleration, and across it by a heading that white angular
    /// acceleration turns: position across, heading and turn rate are a threefold integral of white noise.
    Transition forward_noise(double speed, double direction, double t) const {
        const double t2 = t * t, t3 = t2 * t;
        const pelorus::Matrix<2> along = density * kinematics::white_acceleration(t);
        pelorus::Matrix<3> across;
        across << speed * speed * t2 * t3 / 20.0, speed * t2 * t2 / 8.0, speed * t3 / 6.0,  //
            speed * t2 * t2 / 8.0, t3 / 3.0, t2 / 2.0,                                      //
            speed * t3 / 6.0, t2 / 2.0, t;
        across *= rate_density;
        // Columns: along, speed, across, heading, turn rate.
        const double cosine = std::cos(direction), sine = std::sin(direction);
        Transition turned = Transition::Zero(), q = Transition::Zero(), out;
        turned(0, 0) = turned(1, 2) = cosine;
        turned(1, 0) = sine;
        turned(0, 2) = -sine;
        turned(2, 1) = turned(3, 3) = turned(4, 4) = 1.0;
        q.topLeftCorner<2, 2>() = along;
        q.bottomRightCorner<3, 3>() = across;
        pelorus::small::symmetric_product(turned, q, out);
        return out;
    }
};

void CoordinatedTurnPolar::describe(pelorus::Describe<CoordinatedTurnPolar>& plugin) {
    plugin.title("Coordinated turn by speed and heading")
        .purpose(
            "A turn in the plane at constant speed and turn rate, with speed and heading in the state (constant turn "
            "rate and "
            "velocity, CTRV): what disturbs the speed is kept apart from what turns the target. For cars, ships and "
            "robots.")
        .equation(
            "p' = p + s T sinc(wT/2) (cos(h + wT/2), sin(h + wT/2)), h' = h + wT; Q: q [T^3/3 T^2/2; T^2/2 T] of "
            "position along h + wT/2 "
            "and speed, q_w [s^2 T^5/20 s T^4/8 s T^3/6; . T^3/3 T^2/2; . . T] of position across it, heading and turn "
            "rate")
        .source(
            "X. R. Li, V. P. Jilkov, Survey of maneuvering target tracking, part I: dynamic models, IEEE Transactions "
            "on "
            "Aerospace and Electronic Systems 39(4), 1333-1364, 2003 (horizontal models); R. Schubert, E. Richter, G. "
            "Wanielik, "
            "Comparison and evaluation of advanced motion models for vehicle tracking, FUSION 2008");
    plugin.parameter("noise", &CoordinatedTurnPolar::density)
        .unit("m2/s3")
        .initially("1 m2/s3")
        .min(0.0)
        .doc("spectral density of the acceleration along the way");
    plugin.parameter("turn_rate_noise", &CoordinatedTurnPolar::rate_density)
        .unit("rad2/s3")
        .initially("1e-4 rad2/s3")
        .min(0.0)
        .doc("growth of the turn rate's variance in a second");
    pelorus::describe_priors(plugin, &CoordinatedTurnPolar::prior_position, &CoordinatedTurnPolar::prior_velocity);
    plugin.parameter("prior_turn_rate", &CoordinatedTurnPolar::prior_turn_rate)
        .unit("rad/s")
        .initially("0.1 rad/s")
        .above(0.0)
        .doc("deviation of a turn rate that nothing is known of, about 0");
}

}  // namespace

PELORUS_PLUGIN(CoordinatedTurnPolar, "motion.coordinated_turn_polar");
