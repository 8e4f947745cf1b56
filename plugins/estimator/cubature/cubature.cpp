// estimator.cubature: the cubature Kalman filter. See README.md.
#include "../../common/gaussian/point_plugin.hpp"

namespace {

class Cubature : public gaussian::PointPlugin<Cubature> {
public:
    static void describe(pelorus::Describe<Cubature>& plugin);
    gaussian::PointRule rule(int n) const { return gaussian::cubature_rule(n); }
};

void Cubature::describe(pelorus::Describe<Cubature>& plugin) {
    plugin.title("Cubature Kalman filter")
        .purpose(
            "Mean and covariance of a track through nonlinear motions and sensors without Jacobians: 2n points of "
            "equal "
            "weight, exact for polynomials up to the third degree.")
        .equation(
            "points x +- sqrt(n) S e_i, P = S S', weights 1/(2n), through the motion and, drawn anew, through the "
            "sensor; "
            "K = P_xz P_zz^-1, x = x + K (z - mean of the points' measurements), P = P - K P_zz K'")
        .source(
            "I. Arasaratnam, S. Haykin, Cubature Kalman filters, IEEE Transactions on Automatic Control 54(6), "
            "1254-1269, 2009, appendices A (covariance) and B (square root)");
    describe_parts(plugin);
}

}  // namespace

PELORUS_PLUGIN(Cubature, "estimator.cubature");
