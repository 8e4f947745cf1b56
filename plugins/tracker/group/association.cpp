#include "association.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>

#include <pelorus/small_matrix.hpp>

namespace group {

std::vector<Pair> nearest_first(std::vector<Pair> pairs) {
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
        return std::tie(a.squared_distance, a.left, a.right) < std::tie(b.squared_distance, b.left, b.right);
    });
    std::set<std::size_t> lefts, rights;
    std::vector<Pair> taken;
    for (const Pair& pair : pairs) {
        if (lefts.count(pair.left) != 0 || rights.count(pair.right) != 0) continue;
        lefts.insert(pair.left);
        rights.insert(pair.right);
        taken.push_back(pair);
    }
    return taken;
}

double squared_distance(const Eigen::VectorXd& e, const Eigen::MatrixXd& covariance) {
    using Square = pelorus::small::Bounded<3, 3>;
    const Square given = covariance;
    Square root(given.rows(), given.cols());
    if (!pelorus::small::cholesky(given, root)) return std::numeric_limits<double>::infinity();
    return pelorus::small::inverse_quadratic(root, pelorus::small::Bounded<3, 1>(e));
}

std::optional<std::size_t> nearest_point(const Eigen::VectorXd& place, const Eigen::MatrixXd& covariance,
                                         const extended::Points& points, double gate) {
    std::optional<std::size_t> nearest;
    double least = gate;
    for (std::size_t k = 0; k < points.ids.size(); ++k) {
        const double squared = squared_distance(points.position(k) - place, covariance + points.noise_of(k));
        if (!(squared < least)) continue;
        least = squared;
        nearest = k;
    }
    return nearest;
}

}  // namespace group
