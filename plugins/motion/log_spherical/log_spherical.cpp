// motion.log_spherical: constant velocity and level turns in logarithmic spherical or polar coordinates. See README.md.
#include "log_spherical_model.hpp"

#include "../../common/variants/variants.hpp"

#include <optional>

#include <pelorus/axis_motion.hpp>

namespace {

struct Parameters {
    int dimension = 3;
    std::vector<double> origin;                           // m
    double turn_rate = 0.0;                               // rad/s
    bool is_estimated = false;                            // the turn rate
    std::optional<double> rate_density, prior_turn_rate;  // rad2/s3, rad/s
    double density = 0.0;                                 // m2/s3
    double mean_range = 0.0, prior_log_range = 0.0, prior_angle = 0.0, prior_rate = 0.0;
    double prior_position = 0.0, prior_velocity = 0.0;
};

/// D axes; the turn rate is the last component of the state where it is estimated.
template <int D, bool estimated> struct Model : pelorus::Motion<Model<D, estimated>, 2 * D + estimated>, Parameters {
    static constexpr int moving = 2 * D, size = moving + estimated;
    using Base = pelorus::Motion<Model, size>;
    using typename Base::Cartesian;
    using typename Base::Posterior;
    using typename Base::State;
    using typename Base::Transition;
    static constexpr std::uint32_t flags = PLR_MOTION_TIME_INVARIANT | PLR_MOTION_BACKWARD;
    static constexpr bool cartesian = false;

    static void describe(pelorus::Describe<Model>& plugin);

    void setup(const pelorus::Setup&) {
        if (origin.size() == 1) origin.assign(D, origin.front());
        if (static_cast<int>(origin.size()) != D)
            throw pelorus::ParameterError(
                "origin", "has " + std::to_string(origin.size()) + " elements, expected " + std::to_string(D));
        if (estimated) return;
        if (rate_density)
            throw pelorus::ParameterError("turn_rate_noise", "belongs to an estimated turn rate (estimate_turn_rate)");
        if (prior_turn_rate)
            throw pelorus::ParameterError("prior_turn_rate", "belongs to an estimated turn rate (estimate_turn_rate)");
    }

    pelorus::Space space() const {
        const pelorus::Component log_range{"log_range", "", std::log(mean_range), prior_log_range, false},
            azimuth{"azimuth", "rad", 0.0, prior_angle, true}, elevation{"elevation", "rad", 0.0, prior_angle, true},
            growth{"range_rate_over_range", "1/s", 0.0, prior_rate, false},
            across{D == 2 ? "azimuth_rate" : "cross_rate", "rad/s", 0.0, prior_rate, false},
            up{"elevation_rate", "rad/s", 0.0, prior_rate, false};
        if (D == 2) return with_turn_rate({log_range, azimuth, growth, across});
        return with_turn_rate({log_range, azimuth, elevation, growth, across, up});
    }
    pelorus::Space cartesian_space() const {
        return with_turn_rate(pelorus::kinematic_space(D, {prior_position, prior_velocity}).components());
    }

    State propagate(const State& x, const pelorus::Step& step) const {
        return flat(log_spherical::propagate(full(x), rate_of(x), step.dt), x);
    }
    Transition jacobian(const State& x, const pelorus::Step& step) const {
        const pelorus::Vector<6> s = full(x);
        const double rate = rate_of(x);
        return flat(log_spherical::jacobian<wide>(s, log_spherical::propagate(s, rate, step.dt), rate, step.dt));
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        const pelorus::Vector<3> densities(density, density, D == 3 ? density : 0.0);
        return flat(log_spherical::noise<wide>(full(posterior.mean), full(posterior.predicted), rate_of(posterior.mean),
                                               step.dt, densities, rate_density.value_or(1e-6)));
    }

    Cartesian to_cartesian(const State& x) const {
        Cartesian out = flat(log_spherical::to_cartesian(full(x)), x);
        for (int axis = 0; axis < D; ++axis) out(axis) += origin[static_cast<std::size_t>(axis)];
        return out;
    }
    Transition to_cartesian_jacobian(const State& x) const {
        return flat(log_spherical::beside_turn_rate<wide>(log_spherical::to_cartesian_jacobian(full(x))));
    }
    State from_cartesian(const Cartesian& c) const { return flat(log_spherical::from_cartesian(seen(c)), c); }
    Transition from_cartesian_jacobian(const Cartesian& c) const {
        return flat(log_spherical::beside_turn_rate<wide>(
            log_spherical::from_cartesian_jacobian(log_spherical::from_cartesian(seen(c)))));
    }

private:
    /// Components of three dimensions.
    static constexpr int wide = 6 + estimated;

    pelorus::Space with_turn_rate(std::vector<pelorus::Component> components) const {
        if (estimated) components.push_back({"turn_rate", "rad/s", turn_rate, prior_turn_rate.value_or(0.1), false});
        return components;
    }
    double rate_of(const State& x) const { return estimated ? x(size - 1) : turn_rate; }
    /// Where component i stands among those of three dimensions: the plane lacks the third of each triple, which is 0.
    static constexpr int place(int i) { return i == moving ? 6 : D == 3 ? i : (i < 2 ? i : i + 1); }
    static pelorus::Vector<6> full(const State& x) {
        pelorus::Vector<6> out = pelorus::Vector<6>::Zero();
        for (int i = 0; i < moving; ++i) out(place(i)) = x(i);
        return out;
    }
    /// Position and velocity from the origin.
    pelorus::Vector<6> seen(const Cartesian& c) const {
        pelorus::Vector<6> out = full(c);
        for (int axis = 0; axis < D; ++axis) out(axis) -= origin[static_cast<std::size_t>(axis)];
        return out;
    }
    /// The turn rate, if it is estimated, is that of `rate_from`.
    static State flat(const pelorus::Vector<6>& x, const State& rate_from) {
        State out = rate_from;
        for (int i = 0; i < moving; ++i) out(i) = x(place(i));
        return out;
    }
    static Transition flat(const pelorus::Matrix<wide>& x) {
        Transition out;
        for (int c = 0; c < size; ++c)
            for (int r = 0; r < size; ++r) out(r, c) = x(place(r), place(c));
        return out;
    }
};

template <int D, bool estimated> void Model<D, estimated>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Constant velocity or turn in logarithmic spherical coordinates")
        .purpose(
            "Straight flight or a level turn, estimated as logarithm of the range, angles, and velocity over the "
            "range: what angles alone tell of a target is kept apart from its range. For passive sensors that do not "
            "accelerate; their place is the origin.")
        .equation(
            "p = origin + r u_r, v = r (rho u_r + omega u_b + eta u_e), r = exp(log_range), rho = r'/r, omega = "
            "azimuth' cos(elevation), eta = elevation'; (p, v)' = A(w T) (p, v) in closed form, A that of "
            "motion.coordinated_turn, w the turn rate; F = (ds'/dc') A (dc/ds); Q = J q [T^3/3 T^2/2; T^2/2 T] (x) I "
            "J', J = ds'/dc'")
        .source(
            "V. J. Aidala, S. E. Hammel, Utilization of modified polar coordinates for bearings-only tracking, IEEE "
            "Transactions on Automatic Control 28(3), 283-294, 1983; M. Mallick, M. Morelande, L. Mihaylova, S. "
            "Arulampalam, Y. Yan, Angle-only filtering in three dimensions, in: Integrated Tracking, Classification, "
            "and Sensor Management, Wiley 2012, chapter 1");
    plugin.parameter("dimension", &Parameters::dimension)
        .initially("3")
        .min(2)
        .max(3)
        .doc("3, or 2 for range and azimuth in the x-y plane");
    plugin.parameter("origin", &Parameters::origin)
        .unit("m")
        .initially("[0 m]")
        .rows(1, 3)
        .doc("where range and angles are counted from: the place of the passive sensor");
    plugin.parameter("turn_rate", &Parameters::turn_rate)
        .unit("rad/s")
        .initially("0 rad/s")
        .doc("positive from x to y; 0: straight flight. With estimate_turn_rate the mean where nothing is known of it");
    plugin.parameter("estimate_turn_rate", &Parameters::is_estimated)
        .initially("false")
        .doc("the turn rate is the last component of the state");
    plugin.parameter("turn_rate_noise", &Parameters::rate_density)
        .unit("rad2/s3")
        .min(0.0)
        .doc("growth of the turn rate's variance in a second, where it is estimated; 1e-6 rad2/s3 if absent");
    plugin.parameter("prior_turn_rate", &Parameters::prior_turn_rate)
        .unit("rad/s")
        .above(0.0)
        .doc("deviation of a turn rate that nothing is known of, where it is estimated; 0.1 rad/s if absent");
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s3")
        .initially("1 m2/s3")
        .min(0.0)
        .doc("spectral density of the acceleration on each Cartesian axis");
    plugin.parameter("mean_range", &Parameters::mean_range)
        .unit("m")
        .initially("10 km")
        .above(0.0)
        .doc("the range where nothing is known of it");
    plugin.parameter("prior_log_range", &Parameters::prior_log_range)
        .initially("1")
        .above(0.0)
        .doc("deviation of log_range where nothing is known of it: 0.7 is a factor of two");
    plugin.parameter("prior_angle", &Parameters::prior_angle)
        .unit("rad")
        .initially("1 rad")
        .above(0.0)
        .doc("deviation of an angle that nothing is known of, about 0");
    plugin.parameter("prior_rate", &Parameters::prior_rate)
        .unit("1/s")
        .initially("0.01 1/s")
        .above(0.0)
        .doc("deviation of a component of velocity over range that nothing is known of, about 0");
    pelorus::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity);
}

/// Chooses the class by dimension and by what is known.
struct LogSpherical : variants::Variants<Model<3, false>> {
    static plr_instance create(const pelorus::Setup& setup) {
        const auto chosen = parameters(setup);
        if (chosen.dimension == 2)
            return chosen.is_estimated ? pelorus::instantiate<Model<2, true>>(setup)
                                       : pelorus::instantiate<Model<2, false>>(setup);
        return chosen.is_estimated ? pelorus::instantiate<Model<3, true>>(setup)
                                   : pelorus::instantiate<Model<3, false>>(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(LogSpherical, "motion.log_spherical");
