// motion.random_walk: a position that white noise moves. See README.md.
#include <cmath>

#include <pelorus/axis_motion.hpp>

namespace {

using pelorus::Matrix;
using pelorus::Vector;

struct Parameters {
    int dimension = 3;
    std::vector<double> density;  // m2/s
    double prior_position = 0.0;
};

template <int D> struct Model : pelorus::AxisMotion<Model<D>, 1, D>, Parameters {
    static constexpr bool rank_one = true;  // of the single position on each axis
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD;

    static void describe(pelorus::Describe<Model>& plugin);

    void setup(const pelorus::Setup&) { this->intensity = pelorus::per_axis<D>("noise", density); }
    Matrix<1> transition(double) const { return Matrix<1>::Ones(); }
    Vector<1> unit_factor(double dt) const { return Vector<1>(std::sqrt(std::fabs(dt))); }
    Matrix<1> unit_noise(double dt) const { return Matrix<1>(std::fabs(dt)); }
    std::vector<double> priors() const { return {prior_position}; }
};

template <int D> void Model<D>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Random walk")
        .purpose(
            "A position without a velocity that white noise moves, on one to three axes alike: for targets that stand, "
            "or "
            "for a coordinate that hardly changes, such as a height beside a motion in the plane (motion.composite).")
        .equation("x = p; F = 1, Q = q |T| on each axis")
        .source(
            "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley "
            "2001, 1.4 (Wiener process)");
    plugin.parameter("dimension", &Parameters::dimension).initially("3").min(1).max(3).doc("number of axes: x, y, z");
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s")
        .initially("1 m2/s")
        .min(0.0)
        .rows(1, 3)
        .doc("variance of the position's change in a second, one value or one an axis");
    plugin.parameter("prior_position", &Parameters::prior_position)
        .unit("m")
        .initially("1000 km")
        .above(0.0)
        .doc("deviation of a position component that nothing is known of, about 0");
}

}  // namespace

PELORUS_PLUGIN(pelorus::ByDimension<Model>, "motion.random_walk");
