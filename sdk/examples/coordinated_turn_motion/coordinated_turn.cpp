// org.example.motion.coordinated_turn: flight that turns at a rate which is estimated along with position and velocity.
//
// The state is not moved by a matrix: how far the velocity turns depends on a component of the state. So the model is not
// PLR_MOTION_LINEAR, and an extended Kalman filter asks for the Jacobian at the state it has.
#include <pelorus/pelorus.hpp>

#include "turn.hpp"

namespace {

enum { x, y, z, vx, vy, vz, w, states };  // where the components stand in the state

struct CoordinatedTurn : pelorus::Motion<CoordinatedTurn, states> {
    // Two steps are as good as one (TIME_INVARIANT), and the noise is a function of the step alone.
    static constexpr std::uint32_t flags = PLR_MOTION_TIME_INVARIANT | PLR_MOTION_CONSTANT_NOISE;

    double acceleration_noise = 0;                                  // m2/s3
    double vertical_noise = 0;                                      // m2/s3
    double turn_noise = 0;                                          // rad2/s3
    double prior_position = 0, prior_velocity = 0, prior_turn = 0;  // m, m/s, rad/s

    static void describe(pelorus::Describe<CoordinatedTurn>& plugin);

    pelorus::Space space() const {
        std::vector<pelorus::Component> components =
            pelorus::kinematic_space(3, {prior_position, prior_velocity}).components();
        components.push_back({"turn_rate", "rad/s", 0.0, prior_turn, false});
        return pelorus::Space(std::move(components));
    }

    State propagate(const State& from, const pelorus::Step& step) const {
        const double t = step.dt;
        const Turn turn(from(w) * t);
        State to = from;
        to(x) += t * (turn.along * from(vx) - turn.across * from(vy));
        to(y) += t * (turn.across * from(vx) + turn.along * from(vy));
        to(z) += t * from(vz);
        to(vx) = turn.cosine * from(vx) - turn.sine * from(vy);
        to(vy) = turn.sine * from(vx) + turn.cosine * from(vy);
        return to;
    }

    Transition jacobian(const State& from, const pelorus::Step& step) const {
        const double t = step.dt;
        const Turn turn(from(w) * t);
        Transition f = Transition::Identity();
        f(x, vx) = f(y, vy) = t * turn.along;
        f(x, vy) = -t * turn.across;
        f(y, vx) = t * turn.across;
        f(z, vz) = t;
        f(vx, vx) = f(vy, vy) = turn.cosine;
        f(vx, vy) = -turn.sine;
        f(vy, vx) = turn.sine;
        // By the turn rate: a = w t, so d/dw = t d/da.
        f(x, w) = t * t * (turn.d_along * from(vx) - turn.d_across * from(vy));
        f(y, w) = t * t * (turn.d_across * from(vx) + turn.d_along * from(vy));
        f(vx, w) = -t * (turn.sine * from(vx) + turn.cosine * from(vy));
        f(vy, w) = t * (turn.cosine * from(vx) - turn.sine * from(vy));
        return f;
    }

    Transition noise(const Posterior&, const pelorus::Step& step) const {
        const double t = step.dt;
        const double densities[3] = {acceleration_noise, acceleration_noise, vertical_noise};
        Transition q = Transition::Zero();
        for (int axis = 0; axis < 3; ++axis) {
            q(axis, axis) = densities[axis] * t * t * t / 3;
            q(axis, 3 + axis) = q(3 + axis, axis) = densities[axis] * t * t / 2;
            q(3 + axis, 3 + axis) = densities[axis] * t;
        }
        q(w, w) = turn_noise * t;
        return q;
    }
};

void CoordinatedTurn::describe(pelorus::Describe<CoordinatedTurn>& plugin) {
    plugin.title("Nearly coordinated turn")
        .purpose(
            "Flight at nearly constant speed that turns in the horizontal plane at a rate which is estimated with it; "
            "up and down it moves nearly straight.")
        .equation(
            "a = w T; x' = x + T (S vx - C vy); y' = y + T (C vx + S vy); S = sin(a)/a, C = (1 - cos(a))/a; (vx, vy)' "
            "= R(a) (vx, vy); z' = z + T vz; w' = w; Q = q [T^3/3 T^2/2; T^2/2 T] on each axis, T q_w for w")
        .source(
            "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley "
            "2001, 11.7 (nearly coordinated turn), 6.2.2 (the noise of each axis)");
    plugin.parameter("noise", &CoordinatedTurn::acceleration_noise)
        .unit("m2/s3")
        .initially("0.2 m2/s3")
        .min(0.0)
        .doc("spectral density q of the acceleration on x and on y, beside the turn's");
    plugin.parameter("vertical_noise", &CoordinatedTurn::vertical_noise)
        .unit("m2/s3")
        .initially("0.1 m2/s3")
        .min(0.0)
        .doc("spectral density of the acceleration on z");
    plugin.parameter("turn_noise", &CoordinatedTurn::turn_noise)
        .unit("rad2/s3")
        .initially("1e-4 rad2/s3")
        .min(0.0)
        .doc("spectral density q_w of the turn rate's derivative: within T the rate changes by about sqrt(q_w T)");
    plugin.parameter("prior_position", &CoordinatedTurn::prior_position)
        .unit("m")
        .initially("1000 km")
        .above(0.0)
        .doc("deviation of a position component that nothing is known of");
    plugin.parameter("prior_velocity", &CoordinatedTurn::prior_velocity)
        .unit("m/s")
        .initially("100 m/s")
        .above(0.0)
        .doc("deviation of a velocity component that nothing is known of");
    plugin.parameter("prior_turn_rate", &CoordinatedTurn::prior_turn)
        .unit("rad/s")
        .initially("3 deg/s")
        .above(0.0)
        .doc("deviation of the turn rate of a new track, about 0");
}

}  // namespace

PELORUS_PLUGIN(CoordinatedTurn, "org.example.motion.coordinated_turn");
