#include "track_correction.hpp"

#include <string>

namespace calibration {

TrackCorrection::TrackCorrection(const pelorus::Space& space) {
    static const char* const names[derivatives] = {"position.", "velocity.", "acceleration."};
    for (std::size_t d = 0; d < derivatives; ++d)
        for (std::size_t axis = 0; axis < 3; ++axis)
            places_[d][axis] = space.index(std::string(names[d]) + "xyz"[axis]);
}

Eigen::Matrix3d TrackCorrection::turn(const Pose& pose, const BiasVector& biases) {
    return pose.rotation * misalignment(biases) * pose.rotation.transpose();
}

Eigen::Vector3d TrackCorrection::gathered(const Eigen::VectorXd& mean, const Places& places) const {
    Eigen::Vector3d out = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis)
        if (const int place = places[static_cast<std::size_t>(axis)]; place >= 0) out(axis) = mean(place);
    return out;
}

void TrackCorrection::operator()(const Pose& pose, const Estimate& estimate, Eigen::VectorXd& mean,
                                 Eigen::MatrixXd& covariance) const {
    const Eigen::Index n = mean.size();
    const Eigen::Matrix3d turned = turn(pose, estimate.value);
    Eigen::MatrixXd whole = Eigen::MatrixXd::Identity(n, n);
    BiasSlope over = BiasSlope::Zero(n, bias_count);
    Eigen::VectorXd moved = mean;
    for (std::size_t d = 0; d < derivatives; ++d) {
        const Places& places = places_[d];
        Eigen::Vector3d from = gathered(mean, places);
        if (d == 0) from -= pose.position;
        Eigen::Vector3d to = turned * from;
        if (d == 0) to += pose.position + estimate.value.segment<3>(offset_x);
        Eigen::Matrix<double, 3, bias_count> slope = Eigen::Matrix<double, 3, bias_count>::Zero();
        constexpr double step = 1e-6;  // rad
        for (const int angle : {roll, pitch, yaw}) {
            BiasVector up = estimate.value, down = estimate.value;
            up(angle) += step;
            down(angle) -= step;
            slope.col(angle) = (turn(pose, up) - turn(pose, down)) * from / (2 * step);
        }
        if (d == 0) slope.middleCols<3>(offset_x).setIdentity();
        for (std::size_t row = 0; row < 3; ++row) {
            if (places[row] < 0) continue;
            moved(places[row]) = to(static_cast<Eigen::Index>(row));
            over.row(places[row]) = slope.row(static_cast<Eigen::Index>(row));
            for (std::size_t column = 0; column < 3; ++column)
                if (places[column] >= 0)
                    whole(places[row], places[column]) =
                        turned(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
        }
    }
    mean = moved;
    const Eigen::MatrixXd spread =
        whole * covariance * whole.transpose() + over * estimate.covariance * over.transpose();
    covariance = 0.5 * (spread + spread.transpose());
}

}  // namespace calibration
