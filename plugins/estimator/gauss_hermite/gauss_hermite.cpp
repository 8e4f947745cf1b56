// estimator.gauss_hermite: the Gauss-Hermite Kalman filter. See README.md.
#include "../../common/gaussian/point_plugin.hpp"

namespace {

struct Parameters {
    int order = 3;
};

class GaussHermite : public gaussian::PointPlugin<GaussHermite>, public Parameters {
public:
    static void describe(pelorus::Describe<GaussHermite>& plugin);
    gaussian::PointRule rule(int n) const {
        const double count = gaussian::gauss_hermite_count(n, order);
        if (count > static_cast<double>(max_points))
            throw pelorus::ParameterError("order", std::to_string(order) + " points for each of the " +
                                                       std::to_string(n) + " components of " + motion_.id() + " are " +
                                                       std::to_string(static_cast<long long>(std::min(count, 1e18))) +
                                                       " points, at most " + std::to_string(max_points) +
                                                       " are taken; estimator.cubature needs " + std::to_string(2 * n));
        return gaussian::gauss_hermite_rule(n, order);
    }
};

void GaussHermite::describe(pelorus::Describe<GaussHermite>& plugin) {
    plugin.title("Gauss-Hermite Kalman filter")
        .purpose(
            "Mean and covariance of a track through nonlinear motions and sensors without Jacobians: a grid of order^n "
            "points, exact for polynomials up to degree 2 order - 1 in each component. For few components, and for "
            "judging cheaper filters.")
        .equation(
            "points x + S xi, P = S S', xi the grid of the roots of the Hermite polynomial of that order with the "
            "products "
            "of its quadrature weights, through the motion and, drawn anew, through the sensor; K = P_xz P_zz^-1, P = "
            "P - K "
            "P_zz K'")
        .source(
            "K. Ito, K. Xiong, Gaussian filters for nonlinear filtering problems, IEEE Transactions on Automatic "
            "Control "
            "45(5), 910-927, 2000; I. Arasaratnam, S. Haykin, R. J. Elliott, Discrete-time nonlinear filtering "
            "algorithms "
            "using Gauss-Hermite quadrature, Proceedings of the IEEE 95(5), 953-977, 2007; G. H. Golub, J. H. Welsch, "
            "Calculation of Gauss quadrature rules, Mathematics of Computation 23, 221-230, 1969");
    describe_parts(plugin);
    plugin.parameter("order", &Parameters::order)
        .initially("3")
        .min(2)
        .max(32)
        .doc("points for each component of the state; order^n may be 1024 at most");
}

}  // namespace

PELORUS_PLUGIN(GaussHermite, "estimator.gauss_hermite");
