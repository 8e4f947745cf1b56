// motion.constant_speed_turn: a turn at constant speed in any plane. See README.md.
#include "constant_speed_turn_model.hpp"

#include "../../common/kinematics/white_acceleration.hpp"

#include <pelorus/axis_motion.hpp>

namespace {

using namespace constant_speed_turn;

struct ConstantSpeedTurn : pelorus::Motion<ConstantSpeedTurn, 9> {
    static constexpr std::uint32_t flags = PLR_MOTION_BACKWARD;

    std::vector<double> density;  // m2/s5
    double least_speed = 0.0;     // m/s
    double prior_position = 0.0, prior_velocity = 0.0, prior_acceleration = 0.0;
    Vector<3> intensity;  // m2/s5

    static void describe(pelorus::Describe<ConstantSpeedTurn>& plugin);

    void setup(const pelorus::Setup&) { intensity = pelorus::per_axis<3>("noise", density); }
    pelorus::Space space() const {
        return pelorus::kinematic_space(3, {prior_position, prior_velocity, prior_acceleration});
    }

    State propagate(const State& x, const pelorus::Step& step) const {
        return on_each_axis(constant_speed_turn::Transition(rate_square(x).value, step.dt).value, x);
    }
    Transition jacobian(const State& x, const pelorus::Step& step) const {
        const TurnRateSquare u = rate_square(x);
        const constant_speed_turn::Transition f(u.value, step.dt);
        Transition out = spread(f.value, Vector<3>(Vector<3>::Ones()));
        const State by_square = on_each_axis(f.by_square, x);
        for (int axis = 0; axis < 3; ++axis) {
            out.col(3 + axis) += u.by_velocity(axis) * by_square;
            out.col(6 + axis) += u.by_acceleration(axis) * by_square;
        }
        return out;
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        const Transition q = spread(white_jerk(rate_square(posterior.mean).value, step.dt), intensity);
        return step.dt < 0 ? kinematics::carried_back<9>(jacobian(posterior.mean, step), q) : q;
    }

private:
    TurnRateSquare rate_square(const State& x) const { return {x.segment<3>(3), x.segment<3>(6), least_speed}; }
    static State on_each_axis(const Matrix<3>& f, const State& x) {
        State y = State::Zero();
        for (int row = 0; row < 3; ++row)
            for (int col = 0; col < 3; ++col)
                for (int axis = 0; axis < 3; ++axis) y(row * 3 + axis) += f(row, col) * x(col * 3 + axis);
        return y;
    }
    static Transition spread(const Matrix<3>& block, const Vector<3>& factor) {
        Transition out = Transition::Zero();
        kinematics::add_per_axis(block, factor, out);
        return out;
    }
};

void ConstantSpeedTurn::describe(pelorus::Describe<ConstantSpeedTurn>& plugin) {
    plugin.title("Turn at constant speed in any plane")
        .purpose(
            "A turn whose plane and rate follow from velocity and acceleration, which stay perpendicular to each "
            "other: "
            "aircraft and missiles that manoeuvre in three dimensions without a change of speed.")
        .equation(
            "F = [1 sin(wT)/w (1 - cos(wT))/w^2; 0 cos(wT) sin(wT)/w; 0 -w sin(wT) cos(wT)] on each axis, w = |v x a| "
            "/ |v|^2; Q "
            "= q times the integral over the step of f f', f the last column of F")
        .source(
            "X. R. Li, V. P. Jilkov, Survey of maneuvering target tracking, part I: dynamic models, IEEE Transactions "
            "on "
            "Aerospace and Electronic Systems 39(4), 1333-1364, 2003 (models in three dimensions)");
    plugin.parameter("noise", &ConstantSpeedTurn::density)
        .unit("m2/s5")
        .initially("1 m2/s5")
        .min(0.0)
        .rows(1, 3)
        .doc("spectral density of the jerk, one value or one an axis");
    plugin.parameter("least_speed", &ConstantSpeedTurn::least_speed)
        .unit("m/s")
        .initially("1 m/s")
        .min(0.01)
        .doc("a lower speed counts as this one in the turn rate, which would grow without bound");
    pelorus::describe_priors(plugin, &ConstantSpeedTurn::prior_position, &ConstantSpeedTurn::prior_velocity);
    plugin.parameter("prior_acceleration", &ConstantSpeedTurn::prior_acceleration)
        .unit("m/s2")
        .initially("10 m/s2")
        .above(0.0)
        .doc("deviation of an acceleration component that nothing is known of, about 0");
}

}  // namespace

PELORUS_PLUGIN(ConstantSpeedTurn, "motion.constant_speed_turn");
