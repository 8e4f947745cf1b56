/// What motion.ballistic says of itself.
#pragma once

#include "model.hpp"

namespace ballistic {

template <class Plugin> void describe_forces(pelorus::Describe<Plugin>& plugin) {
    describe_frame(plugin, "flat");
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
    plugin.parameter("integration", &Parameters::integration)
        .initially("runge_kutta")
        .choices(
            {{"runge_kutta", "of fourth order, the Jacobian by the variational equations"},
             {"held", "the acceleration at the last estimate holds over the whole step, and F is that without forces"}})
        .doc("how a step is made");
    plugin.parameter("maximum_step", &Parameters::maximum_step)
        .unit("s")
        .min(1e-3)
        .doc(
            "longest step of the integration, longer ones are divided evenly; 1 s if absent, and with maneuver_rate at "
            "most a twentieth of its reciprocal");
    plugin.parameter("maneuver_rate", &Parameters::maneuver_rate)
        .unit("1/s")
        .above(0.0)
        .doc(
            "reciprocal of the time constant of manoeuvres (Singer); given, the state has an acceleration beyond the "
            "forces");
}

template <class Plugin> void describe_noise(pelorus::Describe<Plugin>& plugin) {
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s3")
        .min(0.0)
        .doc("spectral density of a white acceleration; 0.01 m2/s3 if absent, unless acceleration is given");
    plugin.parameter("acceleration", &Parameters::deviation)
        .unit("m/s2")
        .min(0.0)
        .doc(
            "deviation of an acceleration that is constant over the step, in place of noise; with maneuver_rate the "
            "stationary deviation of the manoeuvres, where 1 m/s2 stands for none given");
    plugin.parameter("noise_over_extent", &Parameters::over_extent)
        .unit("1/s2")
        .min(0.0)
        .doc(
            "with maneuver_rate, in place of acceleration: the variance of the manoeuvres is its square times the "
            "extent of the target or group");
    plugin.parameter("drag_noise", &Parameters::drag_noise)
        .unit("1/s")
        .min(0.0)
        .doc("growth of the variance of log_drag in a second, where it is estimated; 1e-4 1/s if absent");
    pelorus::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity);
    plugin.parameter("prior_log_drag", &Parameters::prior_log_drag)
        .above(0.0)
        .doc("deviation of log_drag where nothing is known of it, about 0; 0.5 if absent");
    plugin.parameter("prior_acceleration", &Parameters::prior_acceleration)
        .unit("m/s2")
        .above(0.0)
        .doc(
            "with maneuver_rate: deviation of an acceleration component that nothing is known of, about 0; "
            "acceleration if absent");
}

template <Drag drag_, bool manoeuvres, Integration integration_, bool over_extent_>
void Model<drag_, manoeuvres, integration_, over_extent_>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Ballistic flight")
        .purpose(
            "Free flight under gravity, the forces of a frame that turns with the Earth, drag by the air, which may be "
            "estimated, and manoeuvres about all this: shells, rockets after burnout, re-entering objects, satellites, "
            "and groups of them.")
        .equation(
            "p' = v, v' = g + a, g = -mu/r^3 (r (1 + c (1 - 5 s^2/r^2)) + 2 c s k) - 2 w x v - w x (w x r) - rho/2 "
            "alpha "
            "|v| v, r from the Earth's centre, k its axis, s = r . k, c = 1.5 J2 (Re/r)^2, rho = rho_0 exp(-h/H), "
            "alpha = "
            "drag_parameter exp(log_drag); with maneuver_rate a' = -maneuver_rate a, else a = 0. runge_kutta: "
            "fourth-order "
            "steps of at most maximum_step, F by the variational equations. held: x- = F x + [T^2/2; T; 0] g at the "
            "last "
            "estimate, F that of straight flight or Singer's. Q = q [T^3/3 T^2/2; T^2/2 T] or s^2 h h', h = [T^2/2; "
            "T], on "
            "each axis; with maneuver_rate Singer's exact noise for unit variance, times s^2 or (x) "
            "noise_over_extent^2 X")
        .source(
            "O. Montenbruck, E. Gill, Satellite Orbits, Springer 2000, 3.2 and 7.2; X. R. Li, V. P. Jilkov, A survey "
            "of "
            "maneuvering target tracking, part II: ballistic target models, Proc. SPIE 4473, 559-581, 2001; R. A. "
            "Singer, "
            "IEEE Transactions on Aerospace and Electronic Systems AES-6(4), 473-483, 1970; W. Koch, Bayesian "
            "approach "
            "to extended object and cluster tracking using random matrices, ibid. 44(3), 1042-1059, 2008 (noise over "
            "the "
            "extent)");
    describe_forces(plugin);
    describe_noise(plugin);
}

}  // namespace ballistic
