// motion.ornstein_uhlenbeck: a velocity that decays and that white acceleration keeps alive. See README.md.
#include "../../common/axis_models/singer.hpp"

#include <pelorus/axis_motion.hpp>

namespace {

using pelorus::Matrix;
using pelorus::Vector;

struct Parameters {
    int dimension = 3;
    double decay_rate = 0.0;      // 1/s
    std::vector<double> density;  // m2/s3
    double prior_position = 0.0, prior_velocity = 0.0;
};

/// Singer's process, whose acceleration decays, one derivative lower: its velocity and acceleration are position and velocity here.
template <int D> struct Model : pelorus::AxisMotion<Model<D>, 2, D>, Parameters {
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD;

    static void describe(pelorus::Describe<Model>& plugin);

    void setup(const pelorus::Setup&) { this->intensity = pelorus::per_axis<D>("noise", density); }
    Matrix<2> transition(double dt) const { return singer::exact_transition(decay_rate, dt).bottomRightCorner<2, 2>(); }
    /// Of spectral density 1 m2/s3, with which the velocity has the variance 1 / (2 decay_rate).
    Matrix<2> unit_noise(double dt) const {
        return singer::exact_noise(decay_rate, dt).bottomRightCorner<2, 2>() / (2.0 * decay_rate);
    }
    std::vector<double> priors() const { return {prior_position, prior_velocity}; }
};

template <int D> void Model<D>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Ornstein-Uhlenbeck velocity")
        .purpose(
            "Motion whose velocity decays at a rate and is disturbed by white acceleration, on one to three axes "
            "alike: "
            "its speed stays bounded however long the target is not seen. For slow targets and long gaps.")
        .equation(
            "x = (p, v), r = decay_rate; F = [1 (1 - e^-rT)/r; 0 e^-rT] on each axis; Q = q times the integral over "
            "the "
            "step of f(t) f(t)', f the last column of F. The velocity's variance tends to q / (2 r). dt < 0: F(dt) "
            "Q(-dt) F(dt)'")
        .source(
            "G. E. Uhlenbeck, L. S. Ornstein, On the theory of the Brownian motion, Physical Review 36, 823-841, 1930; "
            "S. Coraluppi, C. Carthel, Stability and stationarity in target kinematic modeling, IEEE Aerospace "
            "Conference 2012");
    plugin.parameter("dimension", &Parameters::dimension).initially("3").min(1).max(3).doc("number of axes: x, y, z");
    plugin.parameter("decay_rate", &Parameters::decay_rate)
        .unit("1/s")
        .initially("0.01 1/s")
        .above(0.0)
        .doc("reciprocal of the time constant of the velocity");
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s3")
        .initially("1 m2/s3")
        .min(0.0)
        .rows(1, 3)
        .doc("spectral density of the acceleration, one value or one an axis");
    pelorus::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity);
}

}  // namespace

PELORUS_PLUGIN(pelorus::ByDimension<Model>, "motion.ornstein_uhlenbeck");
