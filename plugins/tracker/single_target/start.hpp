/// How a track begins: what is known of its Cartesian components, and when.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "../../common/one_track/filter.hpp"

namespace single_target {

/// Positions, velocities and accelerations over x, y, z (see one_track::kinematic_place); not a number where there is none.
using Kinematics = std::array<double, 9>;

inline Kinematics unknown_kinematics() {
    Kinematics out{};
    out.fill(pelorus::not_a_number);
    return out;
}

/// The first object of a truth message, at its time.
struct TrueStart {
    std::int64_t time = 0;  ///< ns
    Kinematics kinematics{};
    template <class Archive> void state(Archive& archive) { archive(time, kinematics); }
};

/// What a track starts from: components (ascending) of the estimator's Cartesian space, and their moments.
struct Known {
    std::vector<std::int32_t> components;
    one_track::Moments moments;
};

/// The components of `space` that `mean` has and that `deviations` (one a derivative) are given for: N(mean, diag(sd^2)).
inline Known known_kinematics(const pelorus::Space& space, const Kinematics& mean,
                              const std::vector<double>& deviations) {
    std::vector<double> means, variances;
    Known out;
    for (int c = 0; c < space.size(); ++c) {
        const int place = one_track::kinematic_place(space[c].name);
        if (place < 0 || std::isnan(mean[static_cast<std::size_t>(place)])) continue;
        out.components.push_back(c);
        means.push_back(mean[static_cast<std::size_t>(place)]);
        variances.push_back(std::pow(deviations[static_cast<std::size_t>(place / 3)], 2));
    }
    const auto k = static_cast<Eigen::Index>(means.size());
    out.moments.mean = Eigen::Map<const Eigen::VectorXd>(means.data(), k);
    out.moments.covariance = Eigen::Map<const Eigen::VectorXd>(variances.data(), k).asDiagonal();
    return out;
}

/// Of what a sensor's inverse tells, that which the estimator has, in its order.
inline Known known_of_inverse(const pelorus::Space& space, const pelorus::Space& inverse,
                              const one_track::Moments& told) {
    std::vector<int> from;
    Known out;
    for (int c = 0; c < space.size(); ++c) {
        const int place = inverse.index(space[c].name);
        if (place < 0) continue;
        out.components.push_back(c);
        from.push_back(place);
    }
    const auto k = static_cast<Eigen::Index>(from.size());
    out.moments = {Eigen::VectorXd(k), Eigen::MatrixXd(k, k)};
    for (Eigen::Index col = 0; col < k; ++col) {
        out.moments.mean(col) = told.mean(from[static_cast<std::size_t>(col)]);
        for (Eigen::Index row = 0; row < k; ++row)
            out.moments.covariance(row, col) =
                told.covariance(from[static_cast<std::size_t>(row)], from[static_cast<std::size_t>(col)]);
    }
    return out;
}

}  // namespace single_target
