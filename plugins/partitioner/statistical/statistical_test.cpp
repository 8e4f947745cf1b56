#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>

#include "../../common/partition/partition_rig.hpp"

using namespace partition;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Covariances of random orientation; deviations from `least` to `most`, evenly in their logarithms.
MatrixXd covariance_of(int d, double least, double most, std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform(std::log(least), std::log(most));
    MatrixXd a(d, d);
    for (double& x : a.reshaped()) x = normal(random);
    const MatrixXd axes = Eigen::HouseholderQR<MatrixXd>(a).householderQ();
    VectorXd variances(d);
    for (double& v : variances) v = std::exp(2 * uniform(random));
    const MatrixXd r = axes * variances.asDiagonal() * axes.transpose();
    return (r + r.transpose()) / 2;
}

std::vector<std::int64_t> by_all_pairs(const Scene& scene, double probability) {
    const auto d = static_cast<double>(scene.points.rows());
    const double gate = boost::math::quantile(boost::math::chi_squared(d), probability);
    return components_by_pairs(scene.points.cols(), [&](Eigen::Index i, Eigen::Index j) {
        const VectorXd e = scene.points.col(i) - scene.points.col(j);
        const MatrixXd s =
            scene.covariance[static_cast<std::size_t>(i)] + scene.covariance[static_cast<std::size_t>(j)];
        return e.dot(s.llt().solve(e)) < gate;
    });
}

}  // namespace

TEST_CASE("statistical partition: the cells are those of all pairs, whatever the covariances", "[partition]") {
    std::mt19937_64 random(8);
    PartitionerUnderTest statistical("statistical");
    struct Spread {
        double least, most;
    };
    for (int d = 1; d <= 3; ++d)
        for (const Pattern which : {Pattern::uniform, Pattern::clumps, Pattern::ball, Pattern::facing_clouds})
            for (const Spread spread : {Spread{0.2, 0.2}, Spread{0.05, 0.5}, Spread{1e-3, 0.3}, Spread{1e-6, 10}}) {
                INFO(d << " dimensions, pattern " << static_cast<int>(which) << ", deviations to " << spread.most);
                Scene scene;
                scene.points = pattern(which, d, 250, 1, random);
                for (int i = 0; i < 250; ++i)
                    scene.covariance.push_back(covariance_of(d, spread.least, spread.most, random));
                REQUIRE(first_members(statistical.split(scene), 250) == by_all_pairs(scene, 0.999));
            }
}

TEST_CASE("statistical partition: a range that is known well parts what lies close by Euclidean distance",
          "[partition]") {
    // Two objects 60 m apart along the line of sight, deviations 6 m along and 800 m across: reading A of the group scenario.
    std::mt19937_64 random(9);
    std::normal_distribution<double> normal;
    Scene scene;
    scene.points.resize(3, 20);
    for (Eigen::Index i = 0; i < 20; ++i)
        scene.points.col(i) << 1e5 + (i % 2 == 0 ? 60 : 0) + normal(random), 300 * normal(random), 300 * normal(random);
    scene.covariance = {MatrixXd(Eigen::Vector3d(36, 64e4, 64e4).asDiagonal())};
    const auto cells = PartitionerUnderTest("statistical").split(scene);
    REQUIRE(cells.size() == 2);
    CHECK(cells[0].points.size() == 10);
    CHECK(PartitionerUnderTest("distance", "{threshold: 900}").split(scene).size() == 1);
}

TEST_CASE("statistical partition: thousands of points, one huge covariance among them or not", "[partition]") {
    std::mt19937_64 random(10);
    PartitionerUnderTest statistical("statistical");
    Scene scene;
    scene.points = pattern(Pattern::uniform, 3, 3000, 1, random);
    for (int i = 0; i < 3000; ++i) scene.covariance.push_back(covariance_of(3, 0.05, 0.2, random));
    CHECK(first_members(statistical.split(scene), 3000) == by_all_pairs(scene, 0.999));
    scene.covariance[5] *= 1e12;
    CHECK(statistical.split(scene).size() == 1);
}

TEST_CASE("statistical partition: what it cannot do without is asked for", "[partition]") {
    Scene scene;
    scene.points = MatrixXd::Zero(2, 3);
    PartitionerUnderTest statistical("statistical");
    CHECK(statistical.try_split(scene) == PLR_E_ARGUMENT);
    CHECK(statistical.message() == "covariance: statistical distances take the noise of the points, none is given");
    scene.covariance = {MatrixXd::Zero(2, 2)};
    CHECK(statistical.try_split(scene) == PLR_E_NUMERIC);
    CHECK(statistical.message() == "covariance of point 0 is not positive definite");
}
