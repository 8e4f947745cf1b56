// motion.coordinated_turn: a level turn at constant speed and rate, the rate known or estimated. See README.md.
#include "../../common/kinematics/coordinated_turn.hpp"

#include "../../common/kinematics/white_acceleration.hpp"
#include "../../common/variants/variants.hpp"

#include <optional>

#include <pelorus/axis_motion.hpp>

namespace {

struct Parameters {
    int dimension = 3;
    std::optional<double> turn_rate;        // rad/s
    std::vector<double> density;            // m2/s3
    std::optional<double> rate_density;     // rad2/s3
    std::optional<double> prior_turn_rate;  // rad/s
    double prior_position = 0.0, prior_velocity = 0.0;
};

/// D axes; the turn rate is the last component of the state where it is estimated.
template <int D, bool estimated> struct Model : pelorus::Motion<Model<D, estimated>, 2 * D + estimated>, Parameters {
    static constexpr int kinematics_size = 2 * D, size = kinematics_size + estimated;
    using Base = pelorus::Motion<Model<D, estimated>, size>;
    using typename Base::Posterior;
    using typename Base::State;
    using typename Base::Transition;
    using Kinematics = pelorus::Vector<kinematics_size>;
    static constexpr std::uint32_t flags =
        PLR_MOTION_TIME_INVARIANT | PLR_MOTION_BACKWARD |
        (estimated ? 0u : std::uint32_t{PLR_MOTION_LINEAR} | std::uint32_t{PLR_MOTION_CONSTANT_NOISE});

    pelorus::Vector<D> intensity;  // m2/s3

    static void describe(pelorus::Describe<Model>& plugin);

    void setup(const pelorus::Setup&) {
        intensity = pelorus::per_axis<D>("noise", density);
        if (estimated) return;
        if (rate_density)
            throw pelorus::ParameterError("turn_rate_noise", "belongs to an estimated turn rate; turn_rate is given");
        if (prior_turn_rate)
            throw pelorus::ParameterError("prior_turn_rate", "belongs to an estimated turn rate; turn_rate is given");
    }

    pelorus::Space space() const {
        std::vector<pelorus::Component> components =
            pelorus::kinematic_space(D, {prior_position, prior_velocity}).components();
        if (estimated) components.push_back({"turn_rate", "rad/s", 0.0, prior_turn_rate.value_or(0.1), false});
        return components;
    }

    State propagate(const State& x, const pelorus::Step& step) const {
        State y = x;
        const Kinematics before = x.template head<kinematics_size>();
        y.template head<kinematics_size>() = coordinated_turn::transition<D>(rate_of(x), step.dt) * before;
        return y;
    }
    Transition jacobian(const State& x, const pelorus::Step& step) const {
        Transition f = Transition::Identity();
        f.template topLeftCorner<kinematics_size, kinematics_size>() =
            coordinated_turn::transition<D>(rate_of(x), step.dt);
        if constexpr (estimated) {
            const Kinematics before = x.template head<kinematics_size>();
            f.template topRightCorner<kinematics_size, 1>() =
                coordinated_turn::rate_derivative<D>(before, rate_of(x), step.dt);
        }
        return f;
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        Transition q = Transition::Zero();
        kinematics::add_per_axis(kinematics::white_acceleration(std::fabs(step.dt)), intensity, q);
        if (estimated) q(size - 1, size - 1) = rate_density.value_or(1e-4) * std::fabs(step.dt);
        return step.dt < 0 ? kinematics::carried_back<size>(jacobian(posterior.mean, step), q) : q;
    }

private:
    double rate_of(const State& x) const { return estimated ? x(size - 1) : *turn_rate; }
};

template <int D, bool estimated> void Model<D, estimated>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Coordinated turn")
        .purpose(
            "A level turn at constant speed and turn rate, the rate known or estimated as part of the state; with "
            "three "
            "axes the height changes at a constant rate. The second model beside constant velocity for aircraft, ships "
            "and cars.")
        .equation(
            "x-y plane: p' = p + S v + C Jv, v' = cos(wT) v + sin(wT) Jv, S = sin(wT)/w, C = (1 - cos(wT))/w, J = [0 "
            "-1; "
            "1 0]; z: constant velocity. Q = q [T^3/3 T^2/2; T^2/2 T] on each axis; q_w T for the turn rate w. dt < 0: "
            "F(dt) "
            "Q(-dt) F(dt)'")
        .source(
            "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley "
            "2001, 11.7 (coordinated turns)");
    plugin.parameter("dimension", &Parameters::dimension)
        .initially("3")
        .min(2)
        .max(3)
        .doc("number of axes: x, y and, at a constant rate, z");
    plugin.parameter("turn_rate", &Parameters::turn_rate)
        .unit("rad/s")
        .doc("the rate where it is known, positive from x to y; estimated as part of the state if absent");
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s3")
        .initially("1 m2/s3")
        .min(0.0)
        .rows(1, 3)
        .doc("spectral density of the acceleration, one value or one an axis");
    plugin.parameter("turn_rate_noise", &Parameters::rate_density)
        .unit("rad2/s3")
        .min(0.0)
        .doc("growth of the turn rate's variance in a second, where it is estimated; 1e-4 rad2/s3 if absent");
    pelorus::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity);
    plugin.parameter("prior_turn_rate", &Parameters::prior_turn_rate)
        .unit("rad/s")
        .above(0.0)
        .doc("deviation of a turn rate that nothing is known of, about 0; 0.1 rad/s if absent");
}

/// Chooses the class by dimension and by what is known.
struct CoordinatedTurn : variants::Variants<Model<3, true>> {
    static plr_instance create(const pelorus::Setup& setup) {
        const auto chosen = parameters(setup);
        const bool known = chosen.turn_rate.has_value();
        if (chosen.dimension == 2)
            return known ? pelorus::instantiate<Model<2, false>>(setup) : pelorus::instantiate<Model<2, true>>(setup);
        return known ? pelorus::instantiate<Model<3, false>>(setup) : pelorus::instantiate<Model<3, true>>(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(CoordinatedTurn, "motion.coordinated_turn");
