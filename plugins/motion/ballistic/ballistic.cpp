// motion.ballistic: free flight under gravity and drag. See README.md.
#include "flight.hpp"

#include "../../common/kinematics/white_acceleration.hpp"

#include <optional>

#include <pelorus/axis_motion.hpp>

namespace {

using namespace ballistic;

enum class Axes { flat, enu, ned, ecef };
enum class Gravity { none, constant, point, j2 };
enum class Drag { none, known, estimated };

constexpr double standard_gravity = 9.80665;  // m/s2, CGPM 1901

struct Parameters {
    Axes axes = Axes::flat;
    std::optional<std::vector<double>> origin;  // rad, rad, m
    std::optional<Gravity> gravity;
    Drag drag = Drag::none;
    std::optional<double> drag_parameter, air_density, scale_height;  // m2/kg, kg/m3, m
    double maximum_step = 0.0;                                        // s
    std::optional<double> density, deviation;                         // m2/s3, m/s2
    std::optional<double> drag_noise, prior_log_drag;                 // 1/s, 1
    double prior_position = 0.0, prior_velocity = 0.0;
};

/// Throws where a parameter is given that the choices leave without a meaning.
void refuse(bool given, const char* parameter, const char* reason) {
    if (given) throw pelorus::ParameterError(parameter, reason);
}

/// The Earth as the frame sees it.
Earth earth_of(const Parameters& p) {
    Earth earth;
    const Gravity gravity = p.gravity.value_or(p.axes == Axes::flat ? Gravity::constant : Gravity::j2);
    if (p.axes == Axes::flat) {
        refuse(p.origin.has_value(), "origin", "belongs to axes: enu and axes: ned; flat has none");
        if (gravity == Gravity::point || gravity == Gravity::j2)
            throw pelorus::ParameterError("gravity", "is none or constant in axes: flat, which has no centre");
        if (gravity == Gravity::constant) earth.constant = {0.0, 0.0, -standard_gravity};
        return earth;
    }
    if (gravity == Gravity::constant)
        throw pelorus::ParameterError("gravity", "constant belongs to axes: flat; elsewhere it is none, point or j2");
    earth.rate = wgs84::rotation_rate;
    if (gravity != Gravity::none) earth.gravity = wgs84::gravitational_constant;
    if (gravity == Gravity::j2)
        earth.flattening_term = 1.5 * wgs84::j2 * earth.gravity * wgs84::equatorial_radius * wgs84::equatorial_radius;
    if (p.axes == Axes::ecef) {
        refuse(p.origin.has_value(), "origin",
               "belongs to axes: enu and axes: ned; that of ecef is the Earth's centre");
        return earth;
    }
    if (!p.origin)
        throw pelorus::ParameterError("origin", "is needed by axes: enu and axes: ned: latitude, longitude, height");
    const double latitude = (*p.origin)[0];
    if (!(std::fabs(latitude) <= std::acos(0.0) * (1.0 + 1e-15)))
        throw pelorus::ParameterError("origin", "has a latitude beyond the poles");
    const Vector<3> place = place_from_centre(latitude, (*p.origin)[2]);
    const double north = std::cos(latitude), up = std::sin(latitude);
    if (p.axes == Axes::enu) {
        earth.origin = place;
        earth.axis = {0.0, north, up};
    } else {
        earth.origin = {place(1), place(0), -place(2)};
        earth.axis = {north, 0.0, -up};
    }
    return earth;
}

/// The drag parameter's logarithm is the last component of the state where it is estimated.
template <Drag drag_> struct Model : pelorus::Motion<Model<drag_>, drag_ == Drag::estimated ? 7 : 6>, Parameters {
    static constexpr int size = drag_ == Drag::estimated ? 7 : 6;
    using Base = pelorus::Motion<Model<drag_>, size>;
    using typename Base::Posterior;
    using typename Base::State;
    using typename Base::Transition;
    // Under drag, a long step and two short ones agree within the error of the integration only.
    static constexpr std::uint32_t flags = PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_BACKWARD |
                                           (drag_ == Drag::none ? std::uint32_t{PLR_MOTION_TIME_INVARIANT} : 0u);

    Flight flight;

    static void describe(pelorus::Describe<Model>& plugin);

    void setup(const pelorus::Setup&) {
        flight.earth = earth_of(*this);
        flight.flat = axes == Axes::flat;
        flight.maximum_step = maximum_step;
        refuse(density && deviation, "acceleration", "noise is given; the disturbance is the one or the other");
        if (drag_ == Drag::none) {
            constexpr const char* reason = "belongs to drag: known and drag: estimated";
            refuse(drag_parameter.has_value(), "drag_parameter", reason);
            refuse(air_density.has_value(), "air_density", reason);
            refuse(scale_height.has_value(), "scale_height", reason);
        } else {
            flight.drag_parameter = drag_parameter.value_or(1e-4);
            flight.air_density = air_density.value_or(1.225);
            flight.scale_height = scale_height.value_or(7200.0);
        }
        if (drag_ != Drag::estimated) {
            refuse(drag_noise.has_value(), "drag_noise", "belongs to drag: estimated");
            refuse(prior_log_drag.has_value(), "prior_log_drag", "belongs to drag: estimated");
        }
    }

    pelorus::Space space() const {
        std::vector<pelorus::Component> components =
            pelorus::kinematic_space(3, {prior_position, prior_velocity}).components();
        if (size > 6) components.push_back({"log_drag", "", 0.0, prior_log_drag.value_or(0.5), false});
        return components;
    }
    State propagate(const State& x, const pelorus::Step& step) const { return flight.propagate<size>(x, step.dt); }
    Transition jacobian(const State& x, const pelorus::Step& step) const { return flight.jacobian<size>(x, step.dt); }
    Transition noise(const Posterior&, const pelorus::Step& step) const {
        Transition q = Transition::Zero();
        pelorus::Matrix<2> unit = kinematics::white_acceleration(step.dt);
        double intensity = density.value_or(0.01);
        if (deviation) {
            const pelorus::Vector<2> g(step.dt * step.dt / 2.0, std::fabs(step.dt));
            unit = g * g.transpose();
            intensity = *deviation * *deviation;
        }
        if (step.dt < 0) {  // F(dt) Q(-dt) F(dt)' of straight flight
            pelorus::Matrix<2> back = pelorus::Matrix<2>::Identity();
            back(0, 1) = step.dt;
            unit = kinematics::carried_back<2>(back, unit);
        }
        kinematics::add_per_axis<3>(unit, pelorus::Vector<3>(pelorus::Vector<3>::Constant(intensity)), q);
        if (size > 6) q(size - 1, size - 1) = drag_noise.value_or(1e-4) * std::fabs(step.dt);
        return q;
    }
};

template <class Plugin> void describe_forces(pelorus::Describe<Plugin>& plugin) {
    plugin.parameter("axes", &Parameters::axes)
        .initially("flat")
        .choices({{"flat", "z up from a ground that neither curves nor turns"},
                  {"enu", "east, north, up at origin, turning with the Earth"},
                  {"ned", "north, east, down at origin, turning with the Earth"},
                  {"ecef", "from the Earth's centre, x through Greenwich, z through the north pole"}})
        .doc("the axes of the state");
    plugin.parameter("origin", &Parameters::origin)
        .unit("rad, rad, m")
        .rows(3, 3)
        .doc("latitude, longitude and height (WGS84) of the origin of enu and ned");
    plugin.parameter("gravity", &Parameters::gravity)
        .choices({{"none", ""},
                  {"constant", "9.80665 m/s2 down, axes flat only"},
                  {"point", "of a point in the Earth's centre"},
                  {"j2", "with the Earth's flattening"}})
        .doc("constant in axes flat and j2 in the others if absent");
    plugin.parameter("drag", &Parameters::drag)
        .initially("none")
        .choices(
            {{"none", ""}, {"known", "by drag_parameter"}, {"estimated", "as part of the state, about drag_parameter"}})
        .doc("deceleration by the air");
    plugin.parameter("drag_parameter", &Parameters::drag_parameter)
        .unit("m2/kg")
        .above(0.0)
        .doc(
            "drag coefficient times area over mass, the reciprocal of the ballistic coefficient; 1e-4 m2/kg if absent");
    plugin.parameter("air_density", &Parameters::air_density)
        .unit("kg/m3")
        .above(0.0)
        .doc("of the air at height 0; 1.225 kg/m3 if absent");
    plugin.parameter("scale_height", &Parameters::scale_height)
        .unit("m")
        .min(1000.0)
        .doc("height in which the density falls to 1/e; 7.2 km if absent");
    plugin.parameter("maximum_step", &Parameters::maximum_step)
        .unit("s")
        .initially("1 s")
        .min(1e-3)
        .doc("longest step of the integration; longer ones are divided evenly");
}

template <class Plugin> void describe_noise(pelorus::Describe<Plugin>& plugin) {
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s3")
        .min(0.0)
        .doc("spectral density of a white acceleration; 0.01 m2/s3 if neither this nor acceleration is given");
    plugin.parameter("acceleration", &Parameters::deviation)
        .unit("m/s2")
        .min(0.0)
        .doc("deviation of an acceleration that is constant over the step, in place of noise");
    plugin.parameter("drag_noise", &Parameters::drag_noise)
        .unit("1/s")
        .min(0.0)
        .doc("growth of the variance of log_drag in a second, where it is estimated; 1e-4 1/s if absent");
    pelorus::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity);
    plugin.parameter("prior_log_drag", &Parameters::prior_log_drag)
        .above(0.0)
        .doc("deviation of log_drag where nothing is known of it, about 0; 0.5 if absent");
}

template <Drag drag_> void Model<drag_>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Ballistic flight")
        .purpose(
            "Free flight under gravity, the forces of a frame that turns with the Earth, and drag by the air, which "
            "may be "
            "estimated: shells, rockets after burnout, re-entering objects, satellites.")
        .equation(
            "p' = v, v' = -mu/r^3 (r (1 + c (1 - 5 s^2/r^2)) + 2 c s k) - 2 w x v - w x (w x r) - rho/2 alpha |v| v, r "
            "from the "
            "Earth's centre, k its axis, s = r . k, c = 1.5 J2 (Re/r)^2, rho = rho_0 exp(-h/H), alpha = drag_parameter "
            "exp(log_drag). Fourth-order Runge-Kutta steps of at most maximum_step, F by the variational equations. Q "
            "= q [T^3/3 "
            "T^2/2; T^2/2 T] or s^2 g g', g = [T^2/2; T], on each axis")
        .source(
            "O. Montenbruck, E. Gill, Satellite Orbits, Springer 2000, 3.2 and 7.2; X. R. Li, V. P. Jilkov, A survey "
            "of "
            "maneuvering target tracking, part II: ballistic target models, Proc. SPIE 4473, 559-581, 2001");
    describe_forces(plugin);
    describe_noise(plugin);
}

/// Chooses the class by what is made of drag.
struct Ballistic {
    using Default = Model<Drag::none>;
    static constexpr const char* kind = Default::kind;
    static constexpr const char* table_id = Default::table_id;
    static constexpr const char* version = Default::version;
    static const plr_description* description(const char* id) { return pelorus::Describe<Default>::of(id).c(); }
    static plr_instance create(const pelorus::Setup& setup) {
        Default chosen;
        pelorus::Describe<Default>::of().bind(chosen, setup.raw());
        if (chosen.drag == Drag::none) return pelorus::instantiate<Default>(setup);
        return chosen.drag == Drag::known ? pelorus::instantiate<Model<Drag::known>>(setup)
                                          : pelorus::instantiate<Model<Drag::estimated>>(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(Ballistic, "motion.ballistic");
