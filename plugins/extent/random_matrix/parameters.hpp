/// What the classes of extent.random_matrix are told by the config, and how it is described. See README.md.
#pragma once

#include <optional>

#include <pelorus/batch_model.hpp>

#include "../../common/random_matrix/direction.hpp"
#include "../../common/random_matrix/inverse_wishart.hpp"
#include "../../common/random_matrix/spread_parameter.hpp"

namespace random_matrix {

enum class Rule { published, koch, feldmann, lan_li, variational };
enum class InnovationSpread { trace, symmetrised, feldmann };

struct Parameters {
    Rule rule = Rule::published;
    std::optional<InnovationSpread> innovation_spread;
    Start start = Start::published;
    double lambda = 1;
    double decay = 0.1;  // 1/s
    bool follow_velocity = false;
    double follow_after = 5;               // s
    std::optional<double> nominal_extent;  // m^2
    int dimension = 3;

    /// One step of a shape: it is forgotten by and by, and turns with the velocity where it is to follow it.
    template <int D>
    void step(InverseWishart<D>& shape, double dt, const Vector<D>& before, const Vector<D>& after) const {
        shape.forget(decay, dt);
        if (!follow_velocity || !(shape.age >= follow_after)) return;
        if (const auto rotation = turn_of<D>(before, after)) shape.turn(*rotation);
    }
};

/// Whether that update has the kinematics in its own record.
inline bool is_joint(Rule rule) { return rule == Rule::koch || rule == Rule::lan_li || rule == Rule::variational; }

template <class Plugin> void describe_update(pelorus::Describe<Plugin>& plugin) {
    plugin.parameter("update", &Parameters::rule)
        .initially("published")
        .choices(
            {{"published", "Li et al. 2025: the scatter enters as it is, and the sensor's noise stays in the shape"},
             {"koch",
              "Koch 2008: shape and kinematics in one record, no sensor noise; takes a motion in slot `motion`"},
             {"feldmann", "Feldmann, Fraenken, Koch 2011: the sensor's noise is taken out of innovation and scatter"},
             {"lan_li",
              "Lan, Li 2012: as koch, with the sensor's noise taken out of the scatter; takes a motion in slot "
              "`motion`"},
             {"variational",
              "Orguner 2012: shape, kinematics and the points without noise by turns; takes a motion in slot "
              "`motion`"}})
        .doc("how points change the shape");
    plugin.parameter("innovation_spread", &Parameters::innovation_spread)
        .choices({{"trace", "N = e e' tr(X-)/tr(S)"},
                  {"symmetrised", "N = (S^-1 e e' + e e' S^-1)/2, the printed formula made symmetric"},
                  {"feldmann", "N = X-^1/2 S^-1/2 e e' S^-1/2 X-^1/2"}})
        .doc("reading of the innovation's share N; update published only, there trace if absent");
    plugin.parameter("start", &Parameters::start)
        .initially("published")
        .choices(
            {{"published", "one scan: V0 is its undivided scatter, v0 = 2d + 3; the shape is far too large at first"},
             {"consistent", "two scans: the sensor's noise is taken out of their common scatter"}})
        .doc("how the shape begins");
}

/// The one description of all classes of this plugin.
template <class Plugin> void describe_parameters(pelorus::Describe<Plugin>& plugin) {
    plugin.title("Random matrix")
        .purpose(
            "The shape of an extended target or group as an ellipsoid whose squared half axes are the eigenvalues of a "
            "random matrix, learned from the spread of its points. `published` and `feldmann` stand beside an "
            "estimator; `koch`, `lan_li` and `variational` own the kinematics, too, and take a motion in their own "
            "slot.")
        .equation(
            "v- = e^(-tau T) v, V- = V (v- - d - 1)/(v - d - 1), X = V/(v - 2d - 2); v = v- + n, V = V- + N + Z, with "
            "N from the centroid's innovation and Z from the scatter of the points, each as `update` says")
        .source(
            "W. Koch, Bayesian approach to extended object and cluster tracking using random matrices, IEEE "
            "Transactions on Aerospace and Electronic Systems 44(3), 2008; M. Feldmann, D. Fraenken, W. Koch, Tracking "
            "of extended objects and group targets using random matrices, IEEE Transactions on Signal Processing "
            "59(4), 2011; J. Lan, X. R. Li, Tracking of extended object or target group using random matrix - part I: "
            "new model and approach, FUSION 2012; U. Orguner, A variational measurement update for extended target "
            "tracking with random matrices, IEEE Transactions on Signal Processing 60(7), 2012; Li et al., Radar "
            "Science and Technology 23(1), 2025");
    describe_update(plugin);
    random_matrix::describe_lambda(plugin, &Parameters::lambda);
    plugin.parameter("decay", &Parameters::decay)
        .unit("1/s")
        .initially("0.1 1/s")
        .min(0)
        .doc("rate tau at which what is known of the shape is forgotten");
    plugin.parameter("follow_velocity", &Parameters::follow_velocity)
        .initially("false")
        .doc("the shape is turned by the smallest rotation from the velocity before a step to the one predicted");
    plugin.parameter("follow_after", &Parameters::follow_after)
        .unit("s")
        .initially("5 s")
        .min(0)
        .doc("it is turned in steps that end at least so long after the start, when the velocity is known by then");
    plugin.parameter("dimension", &Parameters::dimension).initially("3").min(2).max(3).doc("axes: x, y[, z]");
    plugin.parameter("nominal_extent", &Parameters::nominal_extent)
        .unit("m2")
        .above(0)
        .doc(
            "extent by which a covariance is divided to become a multiple of the extent; update koch and lan_li only, "
            "there 50 m2 if absent");
    plugin.slot("motion", "motion", 0, 1, "update koch, lan_li, variational: a motion F1 (x) I, Q1 (x) I");
    plugin.slot("sensors", "sensor", 0, -1,
                "update koch, lan_li, variational: the sensors whose scans the tracker converts to points");
}

}  // namespace random_matrix
