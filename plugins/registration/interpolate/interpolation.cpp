#include "interpolation.hpp"

namespace interpolate {

int rate_of(const pelorus::Space& space, int component) {
    const std::string& name = space[component].name;
    const std::string position = "position.";
    if (name.compare(0, position.size(), position) == 0) return space.index("velocity." + name.substr(position.size()));
    return space.index(name + "_rate");
}

Weights linear(int size, double u) {
    const auto one = Eigen::MatrixXd::Identity(size, size);
    return {(1.0 - u) * one, u * one};
}

Weights hermite(const pelorus::Space& space, double u, double dt) {
    Weights weights = linear(space.size(), u);
    for (int c = 0; c < space.size(); ++c) {
        const int rate = rate_of(space, c);
        if (rate < 0) continue;
        if (u > 1.0) {
            weights.first(c, c) = 0.0;
            weights.second(c, c) = 1.0;
            weights.second(c, rate) = (u - 1.0) * dt;
            continue;
        }
        const double v = 1.0 - u;
        weights.first(c, c) = v * v * (1.0 + 2.0 * u);
        weights.first(c, rate) = u * v * v * dt;
        weights.second(c, c) = u * u * (1.0 + 2.0 * v);
        weights.second(c, rate) = -u * u * v * dt;
    }
    return weights;
}

streams::Estimate combined(const Weights& weights, const streams::Sample& first, const streams::Sample& second,
                           const pelorus::Space& space) {
    const Eigen::VectorXd value = streams::unwrapped(space, first.value, second.value);
    streams::Estimate estimate;
    estimate.value = weights.first * first.value + weights.second * value;
    estimate.covariance = weights.first * first.covariance * weights.first.transpose() +
                          weights.second * second.covariance * weights.second.transpose();
    return estimate;
}

}  // namespace interpolate
