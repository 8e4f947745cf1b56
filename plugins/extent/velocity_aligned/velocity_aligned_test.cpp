#include "../../../tests/support/extent_under_test.hpp"

using namespace test_support;

namespace {

const std::string name = "velocity_aligned";
const MatrixXd noise = 4 * MatrixXd::Identity(3, 3);

VectorXd kinematics(const Eigen::Vector3d& velocity) {
    VectorXd out = VectorXd::Zero(9);
    out.segment(3, 3) = velocity;
    return out;
}
/// Deviations of position, velocity, acceleration.
MatrixXd covariance(double position, double velocity, double acceleration) {
    VectorXd squares(9);
    squares << VectorXd::Constant(3, position * position), VectorXd::Constant(3, velocity * velocity),
        VectorXd::Constant(3, acceleration * acceleration);
    return squares.asDiagonal();
}
/// An airship's extent with its main axis in that direction of the plane x, y.
MatrixXd towards(double angle) {
    const Eigen::Vector3d u(std::cos(angle), std::sin(angle), 0);
    return 25 * MatrixXd::Identity(3, 3) + 119 * u * u.transpose();
}
/// Degrees between the told main axis and that direction.
double off(const ExtentUnderTest& extent, const MatrixXd& record, double angle) {
    const Eigen::Vector3d u(std::cos(angle), std::sin(angle), 0);
    return std::acos(std::min(1.0, std::fabs(u.dot(Eigen::Vector3d(extent.shape(record).axes.col(0)))))) * 57.29577951;
}

/// Flies an airship that turns by `turn` a second; what is told of its velocity is off by `error` (m/s, along y).
struct Flight {
    ExtentUnderTest extent;
    MatrixXd record;
    double speed, turn, angle = 0, deviation;

    Flight(const std::string& with, double speed_, double turn_, double deviation_)
        : extent(with, name), speed(speed_), turn(turn_), deviation(deviation_) {
        const Cloud first(cloud(3, 16, 1, towards(0) + noise), noise), next(cloud(3, 16, 2, towards(0) + noise), noise);
        record = extent.init({first, next});
    }
    VectorXd told(int k) const {
        VectorXd unit(1);
        pelorus::host::random_service().normal({{5, static_cast<std::uint64_t>(k)}}, 0, 1, unit.data());
        return kinematics(speed * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0) +
                          deviation * unit(0) * Eigen::Vector3d::UnitY());
    }
    void step(int k) {
        const MatrixXd known = covariance(1, deviation, 0.05);
        const VectorXd before = told(k);
        angle += turn;
        record = extent.predict(record, 1, before, told(k), known);
        const Cloud scan(cloud(3, 16, static_cast<std::uint64_t>(100 + k), towards(angle) + noise), noise);
        record =
            extent.update(record, scan, VectorXd::Zero(3), 5 * MatrixXd::Identity(3, 3), told(k + 1), known).records;
    }
};

}  // namespace

TEST_CASE("velocity aligned: mean squares along and across the velocity, less the sensor's noise",
          "[velocity_aligned]") {
    const double lambda = GENERATE(1.0, 0.2);
    const ExtentUnderTest extent("{align_after: 1 s, lambda: " + std::to_string(lambda) + "}", name);
    const MatrixXd truth = towards(0);
    MatrixXd record = extent.init({{cloud(3, 16, 1, truth), noise}, {cloud(3, 16, 2, truth), noise}});
    const Eigen::Vector3d velocity(12, 16, 0), u = velocity / 20;
    double along = 0, across = 0;
    for (int k = 1; k <= 3; ++k) {
        record = extent.predict(record, 1, kinematics(velocity), kinematics(velocity));
        const MatrixXd points = cloud(3, 12, static_cast<std::uint64_t>(10 + k), truth);
        record =
            extent
                .update(record, {points, noise}, VectorXd::Zero(3), 5 * MatrixXd::Identity(3, 3), kinematics(velocity))
                .records;
        const MatrixXd mean = scatter(points) / 11;
        along += (u.dot(mean * u) - 4) / 3;
        across += ((mean.trace() - u.dot(mean * u)) / 2 - 4) / 3;
    }
    const MatrixXd expected = (across * MatrixXd::Identity(3, 3) + (along - across) * u * u.transpose()) / lambda;
    CHECK((extent.shape(record).matrix - expected).norm() < 1e-9 * expected.norm());
}

TEST_CASE("velocity aligned: until it is aligned the random matrix is told", "[velocity_aligned]") {
    const ExtentUnderTest extent("{align_after: 3 s}", name), random("{update: feldmann, start: consistent}");
    const std::vector<Cloud> start{{cloud(3, 16, 1, towards(0)), noise}, {cloud(3, 16, 2, towards(0)), noise}};
    MatrixXd record = extent.init(start), other = random.init(start);
    const VectorXd flying = kinematics({20, 0, 0}), e = VectorXd::Constant(3, 0.5);
    const MatrixXd s = 6 * MatrixXd::Identity(3, 3);
    for (int k = 1; k <= 3; ++k) {
        CHECK((extent.shape(record).matrix - random.shape(other).matrix).norm() < 1e-9);
        record = extent.predict(record, 1, flying, flying);
        other = random.predict(other, 1);
        const Cloud scan(cloud(3, 12, static_cast<std::uint64_t>(20 + k), towards(0)), noise);
        record = extent.update(record, scan, e, s, flying).records;
        other = random.update(other, scan, e, s).records;
    }
    CHECK((extent.shape(record).matrix - random.shape(other).matrix).norm() > 0.1);
}

TEST_CASE("velocity aligned: weighed, it follows a turn that a random matrix lags behind", "[velocity_aligned]") {
    Flight weighed("{weighing: covariance}", 20, 0.1, 0.2);
    const ExtentUnderTest random("{update: feldmann, start: consistent}");
    for (int k = 0; k < 40; ++k) weighed.step(k);
    CHECK(off(weighed.extent, weighed.record, weighed.angle) < 6);
    const auto half_axes = weighed.extent.shape(weighed.record).half_axes;
    CHECK(half_axes(0) == Approx(12).epsilon(0.1));
    CHECK(half_axes(1) == Approx(5).epsilon(0.15));
}

TEST_CASE("velocity aligned: weighed, a direction that is not known does no harm", "[velocity_aligned]") {
    // 1 m/s +- 1 m/s: taken as it is, the direction leads the shape astray.
    Flight weighed("{weighing: covariance}", 1, 0, 1), unweighed("{}", 1, 0, 1);
    double worst = 0, mean_unweighed = 0;
    for (int k = 0; k < 60; ++k) {
        weighed.step(k);
        unweighed.step(k);
        if (k < 10) continue;
        worst = std::max(worst, off(weighed.extent, weighed.record, 0));
        mean_unweighed += off(unweighed.extent, unweighed.record, 0) / 50;
    }
    CHECK(worst < 12);
    CHECK(mean_unweighed > 20);
}

TEST_CASE("velocity aligned: weighed, the attitude to the velocity is learned, not assumed", "[velocity_aligned]") {
    // It flies sideways: its long axis lies across the velocity.
    const ExtentUnderTest extent("{weighing: covariance}", name);
    const double across = std::acos(-1.0) / 2;
    MatrixXd record =
        extent.init({{cloud(3, 16, 1, towards(across)), noise}, {cloud(3, 16, 2, towards(across)), noise}});
    const VectorXd flying = kinematics({20, 0, 0});
    for (int k = 0; k < 40; ++k) {
        record = extent.predict(record, 1, flying, flying, covariance(1, 0.2, 0.05));
        const Cloud scan(cloud(3, 16, static_cast<std::uint64_t>(50 + k), towards(across)), noise);
        record =
            extent
                .update(record, scan, VectorXd::Zero(3), 5 * MatrixXd::Identity(3, 3), flying, covariance(1, 0.2, 0.05))
                .records;
    }
    CHECK(off(extent, record, across) < 4);
}

TEST_CASE("velocity aligned: weighed, a ball is told as a ball", "[velocity_aligned]") {
    const ExtentUnderTest extent("{weighing: covariance}", name), random("{update: feldmann, start: consistent}");
    const MatrixXd ball = 25 * MatrixXd::Identity(3, 3);
    const std::vector<Cloud> start{{cloud(3, 16, 1, ball), noise}, {cloud(3, 16, 2, ball), noise}};
    MatrixXd record = extent.init(start), other = random.init(start);
    const VectorXd flying = kinematics({20, 0, 0}), e = VectorXd::Zero(3);
    const MatrixXd s = 5 * MatrixXd::Identity(3, 3);
    // The largest half axis less the smallest, mean over the last scans: a random matrix takes chance for shape.
    double apart = 0, apart_of_other = 0;
    for (int k = 0; k < 60; ++k) {
        record = extent.predict(record, 1, flying, flying, covariance(1, 0.2, 0.05));
        const Cloud scan(cloud(3, 16, static_cast<std::uint64_t>(50 + k), ball + noise), noise);
        record = extent.update(record, scan, e, s, flying, covariance(1, 0.2, 0.05)).records;
        other = random.update(random.predict(other, 1), scan, e, s).records;
        if (k < 20) continue;
        const auto half_axes = extent.shape(record).half_axes, half_axes_of_other = random.shape(other).half_axes;
        apart += (half_axes(0) - half_axes(2)) / 40;
        apart_of_other += (half_axes_of_other(0) - half_axes_of_other(2)) / 40;
    }
    const auto half_axes = extent.shape(record).half_axes;
    CAPTURE(apart, apart_of_other);
    CHECK(apart < 0.5 * apart_of_other);
    CHECK(half_axes.mean() == Approx(5).epsilon(0.05));
}
