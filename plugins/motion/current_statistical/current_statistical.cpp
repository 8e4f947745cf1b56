// motion.current_statistical: Singer's model about the acceleration that was estimated last. See README.md.
#include "../../common/axis_models/current_statistical.hpp"

namespace {

using namespace axis_models;

struct Parameters : AccelerationParameters {
    double maneuver_rate = 0.0;                                     // 1/s
    double maximum_acceleration = 0.0, minimum_acceleration = 0.0;  // m/s2
};

template <int D> struct Model : CurrentStatisticalMotion<Model<D>, D>, Parameters {
    // The mean moves as by a constant acceleration, which leaves the statistics as they are: a step may be cut.
    static constexpr std::uint32_t flags = PLR_MOTION_TIME_INVARIANT | PLR_MOTION_EXACT_NOISE;

    static void describe(pelorus::Describe<Model>& plugin);

    CurrentStatistics statistics(double acceleration, int, const pelorus::Step&) const {
        const double room = (acceleration >= 0.0 ? maximum_acceleration : minimum_acceleration) - acceleration;
        return {acceleration, maneuver_rate, rayleigh_ratio * room * room};
    }
};

template <int D> void Model<D>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Current statistical model")
        .purpose(
            "Singer's manoeuvres about the acceleration that was estimated last, spread by what is left between it and "
            "the largest (or smallest) acceleration that the target is capable of, on one to three axes alike.")
        .equation(
            "x = (p, v, a), r = maneuver_rate; the mean moves by [1 T T^2/2; 0 1 T; 0 0 1], deviations from it by "
            "Singer's F; Q = s^2 times Singer's exact noise for unit variance; s^2 = (4 - pi)/pi (a_max - a)^2 for a "
            ">= 0, else (4 - pi)/pi (a_min - a)^2, a of the posterior before the step")
        .source(
            "H. R. Zhou, K. S. P. Kumar, A current statistical model and adaptive algorithm for estimating maneuvering "
            "targets, Journal of Guidance, Control and Dynamics 7(5), 596-602, 1984");
    describe_dimension(plugin);
    plugin.parameter("maneuver_rate", &Parameters::maneuver_rate)
        .unit("1/s")
        .initially("0.6 1/s")
        .above(0.0)
        .doc("reciprocal of the time constant with which an acceleration returns to its mean");
    plugin.parameter("maximum_acceleration", &Parameters::maximum_acceleration)
        .unit("m/s2")
        .initially("100 m/s2")
        .above(0.0)
        .doc("largest acceleration along an axis");
    plugin.parameter("minimum_acceleration", &Parameters::minimum_acceleration)
        .unit("m/s2")
        .initially("-100 m/s2")
        .below(0.0)
        .doc("smallest acceleration along an axis, below 0");
    describe_priors(plugin);
}

}  // namespace

PELORUS_PLUGIN(pelorus::ByDimension<Model>, "motion.current_statistical");
