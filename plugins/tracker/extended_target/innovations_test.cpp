/// That the tracker tells innovations, and that they are as large as it says.
#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>
#include <catch2/catch.hpp>
#include <Eigen/Dense>

#include "tracking_rig.hpp"

namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using extended_target::Tracking;

/// A target drawn from the motion that the tracker has (`airship_motion`), seen as points of its shape by a sensor of 1 m.
class DrawnTarget {
public:
    explicit DrawnTarget(std::uint64_t seed) : seed_(seed) {
        state_.col(1) = Vector3d(20, 0, -2);
        state_.col(2) = 0.5 * normals(3);  // its prior deviation
    }
    /// Points as columns; each call is a second later.
    MatrixXd next(int points) {
        if (step_++ > 0) {
            const double keep = std::exp(-0.1);
            const Vector3d a = state_.col(2), shock = 0.1 * normals(3);
            state_.col(0) += state_.col(1) + 0.5 * (a + shock);
            state_.col(1) += a + shock;
            state_.col(2) = keep * a + shock;
        }
        const Vector3d deviation(std::sqrt(144 + 1), std::sqrt(25 + 1), std::sqrt(25 + 1));
        const MatrixXd unit = normals(3 * points).reshaped(3, points);
        return (deviation.asDiagonal() * unit).colwise() + Vector3d(state_.col(0));
    }

private:
    VectorXd normals(int count) {
        VectorXd out(count);
        pelorus::host::random_service().normal({{78, seed_}}, drawn_, count, out.data());
        drawn_ += static_cast<std::uint64_t>(count);
        return out;
    }

    std::uint64_t seed_, drawn_ = 0;
    int step_ = 0;
    Eigen::Matrix3d state_ = Eigen::Matrix3d::Zero();  // position, velocity and acceleration as columns
};

MatrixXd position_block(const MatrixXd& covariance) { return covariance.topLeftCorner(3, 3); }

}  // namespace

TEST_CASE("extended target: the centroid's innovation is told from the first prediction on", "[extended_target]") {
    const auto update = GENERATE("feldmann", "koch");
    Tracking run(std::string("{update: ") + update + ", start: consistent}");
    run.scan(0);
    run.scan(1);
    CHECK(run.innovations().empty());  // these two make the start
    const auto before = run.told().back();
    run.scan(2);
    REQUIRE(run.innovations().size() == 1);
    // S = H P- H' + (X- + R)/n is larger than what it was before the prediction, so that d^2 is less than by that.
    const VectorXd predicted = before.mean.head(3) + before.mean.segment(3, 3) + 0.5 * before.mean.tail(3);
    const VectorXd innovation = Tracking::target_points(2, 8).rowwise().mean() - predicted;
    const MatrixXd noise = (before.extent + MatrixXd::Identity(3, 3)) / 8;
    const double largest = innovation.dot((position_block(before.covariance) + noise).inverse() * innovation);
    CHECK(run.innovations()[0] > 0);
    if (std::string(update) == "feldmann") CHECK(run.innovations()[0] < largest);
    run.empty(3);
    CHECK(run.innovations().size() == 1);
    run.scan(4);
    CHECK(run.innovations().size() == 2);
}

TEST_CASE("extended target: innovations of a target that moves as the motion says are chi-square",
          "[extended_target]") {
    // Those of a filter that is right are independent of each other, so the sum of their squares is chi-square with as many degrees
    // of freedom as they have components together. That the shape is not known, but estimated, moves the sum by -1.5 % in the
    // long run: the mean of an inverse Wishart density grows as it is predicted. One standard deviation is 2.6 % here.
    constexpr int scans = 200, runs = 5;
    double sum = 0;
    for (std::uint64_t seed = 0; seed < runs; ++seed) {
        Tracking run("{update: feldmann, start: consistent}");
        DrawnTarget target(seed);
        for (int k = 0; k < scans; ++k) run.scan_at(k, target.next(16));
        const std::vector<double> squares = run.innovations();
        REQUIRE(squares.size() == scans - 2);  // two make the start
        for (const double squared : squares) sum += squared;
    }
    const boost::math::chi_squared expected(3.0 * (scans - 2) * runs);
    CHECK(sum > boost::math::quantile(expected, 0.001));
    CHECK(sum < boost::math::quantile(expected, 0.999));
}
