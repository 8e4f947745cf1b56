// estimator.unscented: the unscented Kalman filter. See README.md.
#include "../../common/gaussian/point_plugin.hpp"

#include <cstdio>

namespace {

struct Parameters {
    double alpha = 1.0, beta = 2.0, kappa = 0.0;
};

class Unscented : public gaussian::PointPlugin<Unscented>, public Parameters {
public:
    static void describe(pelorus::Describe<Unscented>& plugin);
    gaussian::PointRule rule(int n) const {
        if (!(n + kappa > 0.0)) {
            char given[32];
            std::snprintf(given, sizeof given, "%g", kappa);
            throw pelorus::ParameterError("kappa", std::string("is ") + given + ", expected more than -" +
                                                       std::to_string(n) + ": n + kappa must be positive, and " +
                                                       motion_.id() + " has n = " + std::to_string(n) + " components");
        }
        return gaussian::unscented_rule(n, alpha, beta, kappa);
    }
};

void Unscented::describe(pelorus::Describe<Unscented>& plugin) {
    plugin.title("Unscented Kalman filter")
        .purpose(
            "Mean and covariance of a track through nonlinear motions and sensors without Jacobians: the mean and 2n "
            "points about it, with weights that may tell more of the distribution than a cubature rule's.")
        .equation(
            "lambda = alpha^2 (n + kappa) - n; points x and x +- sqrt(n + lambda) S e_i, P = S S'; weights 1/(2(n + "
            "lambda)), of the centre lambda/(n + lambda), in covariances 1 - alpha^2 + beta more; through the motion "
            "and, "
            "drawn anew, through the sensor; K = P_xz P_zz^-1, P = P - K P_zz K'")
        .source(
            "S. J. Julier, J. K. Uhlmann, Unscented filtering and nonlinear estimation, Proceedings of the IEEE 92(3), "
            "401-422, 2004; E. A. Wan, R. van der Merwe, The unscented Kalman filter for nonlinear estimation, IEEE "
            "Adaptive Systems for Signal Processing, Communications, and Control Symposium, 153-158, 2000 (points and "
            "weights); R. van der Merwe, E. A. Wan, The square-root unscented Kalman filter for state and "
            "parameter-estimation, ICASSP 2001, 3461-3464");
    describe_parts(plugin);
    plugin.parameter("alpha", &Parameters::alpha)
        .initially("1")
        .above(0.0)
        .max(1.0)
        .doc("how far the points lie out: 1 beyond 1 deviation for sure, small values close to the mean");
    plugin.parameter("beta", &Parameters::beta)
        .initially("2")
        .min(0.0)
        .doc("more weight of the centre in covariances; 2 suits normal distributions");
    plugin.parameter("kappa", &Parameters::kappa)
        .initially("0")
        .doc(
            "moves weight to the centre; more than -n. Where the centre's weight is negative and beta below alpha^2, "
            "an "
            "indefinite result fails its item");
}

}  // namespace

PELORUS_PLUGIN(Unscented, "estimator.unscented");
