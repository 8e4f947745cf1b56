/// What models of position, velocity and acceleration share whose noise depends on the posterior: Q = Q1 (x) diag(weights), with a
/// weight an axis that is computed anew for each step.
#pragma once

#include <pelorus/axis_motion.hpp>

namespace axis_models {

using pelorus::Matrix;
using pelorus::Vector;

/// (4 - pi) / pi: the variance of a Rayleigh distribution over the square of its mean. Current statistical models take the
/// distance of the acceleration from its bound for such a mean (Zhou, Kumar 1984).
inline constexpr double rayleigh_ratio = 0.27323954473516270;

/// Names and priors of the parameters that all of them take.
struct AccelerationParameters {
    int dimension = 3;
    double prior_position = 0.0, prior_velocity = 0.0, prior_acceleration = 0.0;

    /// In the order of the components: deviations of what nothing is known of.
    std::vector<double> priors() const { return {prior_position, prior_velocity, prior_acceleration}; }
};

template <class Plugin> void describe_dimension(pelorus::Describe<Plugin>& plugin) {
    plugin.parameter("dimension", &AccelerationParameters::dimension)
        .initially("3")
        .min(1)
        .max(3)
        .doc("number of axes: x, y, z");
}

/// Declares `prior_position`, `prior_velocity` and `prior_acceleration`.
template <class Plugin, class Parameters>
void describe_priors(pelorus::Describe<Plugin>& plugin, double Parameters::*position, double Parameters::*velocity,
                     double Parameters::*acceleration) {
    pelorus::describe_priors(plugin, position, velocity);
    plugin.parameter("prior_acceleration", acceleration)
        .unit("m/s2")
        .initially("10 m/s2")
        .above(0.0)
        .doc("deviation of an acceleration component that nothing is known of, about 0");
}
template <class Plugin> void describe_priors(pelorus::Describe<Plugin>& plugin) {
    using P = AccelerationParameters;
    describe_priors(plugin, &P::prior_position, &P::prior_velocity, &P::prior_acceleration);
}

/// F1 x on every axis, x ordered by derivative.
template <int D> Vector<3 * D> moved(const Matrix<3>& f1, const Vector<3 * D>& x) {
    Vector<3 * D> out;
    for (int axis = 0; axis < D; ++axis)
        for (int r = 0; r < 3; ++r)
            out(r * D + axis) = f1(r, 0) * x(axis) + f1(r, 1) * x(D + axis) + f1(r, 2) * x(2 * D + axis);
    return out;
}

}  // namespace axis_models
