// motion.planar: manoeuvres in a plane that is told from outside, as long as it is told. See README.md.
#include "../../common/axis_models/singer.hpp"

#include <algorithm>

#include <pelorus/axis_motion.hpp>

namespace {

using pelorus::Matrix;
using pelorus::Vector;

struct Planar : pelorus::Motion<Planar, 9> {
    static constexpr std::uint32_t flags =
        PLR_MOTION_LINEAR | PLR_MOTION_TIME_INVARIANT | PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD;

    double rate = 0.0, free = 0.0, across = 0.0;                                  // 1/s, m/s2, m/s2
    double prior_position = 0.0, prior_velocity = 0.0, prior_acceleration = 0.0;  // m, m/s, m/s2

    static void describe(pelorus::Describe<Planar>& plugin);
    void setup(const pelorus::Setup&) {
        if (across > free)
            throw pelorus::ParameterError("acceleration_across", "is above acceleration; it is the smaller one");
    }

    pelorus::Space space() const {
        return pelorus::kinematic_space(3, {prior_position, prior_velocity, prior_acceleration});
    }
    State propagate(const State& x, const pelorus::Step& step) const {
        const Matrix<3> f = singer::exact_transition(rate, step.dt);
        State out;
        for (int row = 0; row < 3; ++row)
            for (int axis = 0; axis < 3; ++axis)
                out(3 * row + axis) = f(row, 0) * x(axis) + f(row, 1) * x(3 + axis) + f(row, 2) * x(6 + axis);
        return out;
    }
    Transition jacobian(const State&, const pelorus::Step& step) const {
        return product(singer::exact_transition(rate, step.dt), Matrix<3>::Identity());
    }
    Transition noise(const Posterior&, const pelorus::Step& step) const {
        return product(singer::exact_noise(rate, step.dt), accelerations(step));
    }

private:
    /// A (x) B: a block for each pair of derivatives.
    static Transition product(const Matrix<3>& a, const Matrix<3>& b) {
        Transition out;
        for (int row = 0; row < 3; ++row)
            for (int col = 0; col < 3; ++col) out.block<3, 3>(3 * row, 3 * col) = a(row, col) * b;
        return out;
    }
    /// Stationary covariance of the acceleration: s^2 (I - n n') + c^2 n n' while a plane is told, s^2 I otherwise.
    Matrix<3> accelerations(const pelorus::Step& step) const {
        Matrix<3> out = free * free * Matrix<3>::Identity();
        const Vector<3> normal = Eigen::Map<const Vector<3>>(input(step, 0));
        const double holds = std::clamp(*input(step, 1), 0.0, 1.0), square = normal.squaredNorm();
        if (square > 0.0 && holds > 0.0)
            out -= holds * (free * free - across * across) / square * normal * normal.transpose();
        return out;
    }
};

void Planar::describe(pelorus::Describe<Planar>& plugin) {
    plugin.title("Manoeuvres in a plane")
        .purpose(
            "Singer's model in space whose manoeuvres keep to a plane while somebody says that they do: across it "
            "accelerations are expected to be small. analyzer.plane_motion says so and tells the normal; without "
            "that, or once the plane is rejected, all directions are alike.")
        .equation(
            "F = F1 (x) I, Q = Q1 (x) (s^2 (I - h n n') + c^2 h n n'), F1 and Q1 of motion.singer for a stationary "
            "deviation of 1, s = acceleration, c = acceleration_across, n the normal, h in 0 .. 1 whether it holds")
        .source(
            "R. A. Singer, Estimating optimal tracking filter performance for manned maneuvering targets, IEEE "
            "Transactions on Aerospace and Electronic Systems AES-6(4), 473-483, 1970");
    plugin.parameter("maneuver_rate", &Planar::rate)
        .unit("1/s")
        .initially("0.1 1/s")
        .above(0.0)
        .doc("reciprocal of the manoeuvres' time constant");
    plugin.parameter("acceleration", &Planar::free)
        .unit("m/s2")
        .initially("10 m/s2")
        .above(0.0)
        .doc("stationary deviation of the acceleration, of each component in the plane, and of all where none holds");
    plugin.parameter("acceleration_across", &Planar::across)
        .unit("m/s2")
        .initially("1 m/s2")
        .min(0.0)
        .doc("that of the component across the plane while it holds");
    pelorus::describe_priors(plugin, &Planar::prior_position, &Planar::prior_velocity);
    plugin.parameter("prior_acceleration", &Planar::prior_acceleration)
        .unit("m/s2")
        .initially("10 m/s2")
        .above(0.0)
        .doc("deviation of an acceleration component that nothing is known of, about 0");
    plugin.input("plane_normal", "", {0.0, 0.0, 1.0}, "normal of the plane; its length does not matter");
    plugin.input("plane_holds", "", {0.0}, "1: the motion keeps to the plane; 0: it does not; between: so much of it");
}

}  // namespace

PELORUS_PLUGIN(Planar, "motion.planar");
