#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "../../../tests/support/filter_under_test.hpp"
#include "../../../tests/support/sensor_checks.hpp"
#include "../../common/sensing/conversion.hpp"

using namespace test_support;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

const double pi = std::acos(-1.0), degree = pi / 180;

/// A filter that is given positions, and the same around it that is given what `sensor` measures.
struct Filters {
    Filters(const std::string& dimension, const std::string& sensor_name, const Values& sensor_values,
            const std::string& conversion = "predicted", const std::string& noise = "0.01")
        : motion("motion", "constant_velocity", {{"dimension", dimension}, {"noise", noise}}),
          points("sensor", "position", {{"dimension", dimension}}),
          sensor("sensor", sensor_name, sensor_values),
          inside("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "points", &points}}),
          instance("estimator", "converted", {{"conversion", conversion}},
                   {{"estimator", "", &inside}, {"sensors", "radar", &sensor}}),
          filter(instance),
          kalman(inside) {}

    struct Updated {
        Batch record;
        double log_likelihood;
        VectorXd innovation;
        MatrixXd covariance;
    };
    static Updated update(const EstimatorUnderTest& by, const Batch& record, const VectorXd& z, const MatrixXd& noise) {
        Call call;
        Batch measured(z.size(), 1), out(by.record_size(), 1);
        measured[0] = z;
        EstimatorUnderTest::Told told(z.size(), 1);
        REQUIRE(by.update(call, 0, record, measured, pelorus::const_view(noise), out, told) == PLR_OK);
        return {out, told.log_likelihood[0](0), told.innovation[0], told.covariance[0]};
    }
    Updated update(const Batch& record, const VectorXd& z, const MatrixXd& noise) const {
        return update(filter, record, z, noise);
    }
    Batch predict(const Batch& record, double dt) const {
        Call call;
        Batch out(filter.record_size(), 1);
        REQUIRE(filter.predict(call, pelorus::const_view(&dt, 1, 1, 1), record, out) == PLR_OK);
        return out;
    }
    std::pair<VectorXd, MatrixXd> moments(const Batch& record) const {
        Call call;
        Batch x(filter.n(), 1), p(filter.n(), filter.n());
        REQUIRE(filter.moments(call, record, x, p) == PLR_OK);
        return {x[0], p[0]};
    }

    Instance motion, points, sensor, inside, instance;
    EstimatorUnderTest filter, kalman;
};

/// E f f' over independent standard normal numbers, by the product of Gauss-Hermite rules of five points (M. Abramowitz, I. A.
/// Stegun, Handbook of Mathematical Functions, 1964, table 25.10, for the weight of a normal density).
template <class Error> MatrixXd mean_square(int numbers, Error error) {
    const double nodes[] = {0, 1.3556261799742659, -1.3556261799742659, 2.8569700138728056, -2.8569700138728056};
    const double weights[] = {8.0 / 15, 0.22207592200561266, 0.22207592200561266, 0.011257411327720691,
                              0.011257411327720691};
    MatrixXd sum;
    for (int point = 0, total = static_cast<int>(std::pow(5, numbers)); point < total; ++point) {
        VectorXd drawn(numbers);
        double weight = 1;
        for (int k = 0, rest = point; k < numbers; ++k, rest /= 5) {
            drawn(k) = nodes[rest % 5];
            weight *= weights[rest % 5];
        }
        const VectorXd e = error(drawn);
        if (point == 0) sum = MatrixXd::Zero(e.size(), e.size());
        sum += weight * e * e.transpose();
    }
    return sum;
}

struct Position {
    VectorXd mean;
    MatrixXd covariance;
};
Position converted(const Instance& sensor, sensing::Conversion at, const VectorXd& z, const MatrixXd& noise,
                   const VectorXd& place, const MatrixXd& spread) {
    const sensing::Converter converter(sensor.as<pelorus::SensorPart>());
    Position out{VectorXd(z.size()), MatrixXd(z.size(), z.size())};
    std::vector<double> memory(static_cast<std::size_t>(converter.doubles()));
    Call call;
    converter.convert(
        call, at,
        {pelorus::const_view(z), pelorus::const_view(noise), pelorus::const_view(place), pelorus::const_view(spread)},
        pelorus::view(out.mean), pelorus::view(out.covariance), memory.data());
    REQUIRE(call.status() == PLR_OK);
    return out;
}

}  // namespace

TEST_CASE("a converted polar measurement has the covariance of its error over all places that are predicted",
          "[converted]") {
    const Instance radar("sensor", "polar");
    const double sr = 50, sa = 3 * degree;
    const Eigen::Vector2d place(30e3, -40e3);
    Eigen::Matrix2d spread;
    spread << 4e6, 1e6, 1e6, 9e6;
    const Eigen::Matrix2d root = spread.llt().matrixL();
    const MatrixXd exact = mean_square(4, [&](const VectorXd& u) {
        const Eigen::Vector2d x = place + root * u.head(2);
        const double r = x.norm() + sr * u(2), a = std::atan2(x(1), x(0)) + sa * u(3);
        return VectorXd(std::exp(sa * sa / 2) * r * Eigen::Vector2d(std::cos(a), std::sin(a)) - x);
    });
    const Eigen::Matrix2d noise = Eigen::Vector2d(sr * sr, sa * sa).asDiagonal();
    const Eigen::Vector2d z(51e3, -0.9);
    const Position told = converted(radar, sensing::Conversion::predicted, z, noise, place, spread);
    CHECK((told.covariance - exact).cwiseAbs().maxCoeff() < 1e-6 * exact.maxCoeff());
    CHECK((told.mean - std::exp(sa * sa / 2) * 51e3 * Eigen::Vector2d(std::cos(0.9), -std::sin(0.9))).norm() < 1e-6);
    // Another measurement has the same covariance; at the measured place it has another one.
    const Eigen::Vector2d other(49e3, -0.95);
    CHECK(converted(radar, sensing::Conversion::predicted, other, noise, place, spread).covariance == told.covariance);
    const Position there = converted(radar, sensing::Conversion::measured, other, noise, place, spread);
    CHECK(there.covariance == SensorUnderTest(radar).invert(other, noise).second);
    CHECK((there.covariance - exact).norm() > 0.03 * exact.norm());
}

TEST_CASE("a converted spherical measurement has the covariance of its error over all places that are predicted",
          "[converted]") {
    const Instance radar("sensor", "spherical");
    const Eigen::Vector3d place(30e3, 40e3, 20e3), sd(100, 2 * degree, 1 * degree);
    Eigen::Matrix3d root;
    root << 2e3, 0, 0, 5e2, 1e3, 0, -3e2, 2e2, 1.5e3;
    const MatrixXd exact = mean_square(6, [&](const VectorXd& u) {
        const Eigen::Vector3d x = place + root * u.head(3);
        const double r = x.norm() + sd(0) * u(3), a = std::atan2(x(1), x(0)) + sd(1) * u(4),
                     e = std::atan2(x(2), std::hypot(x(0), x(1))) + sd(2) * u(5);
        const double ka = std::exp(sd(1) * sd(1) / 2), ke = std::exp(sd(2) * sd(2) / 2);
        return VectorXd(Eigen::Vector3d(ka * ke * r * std::cos(e) * std::cos(a),
                                        ka * ke * r * std::cos(e) * std::sin(a), ke * r * std::sin(e)) -
                        x);
    });
    const Position told = converted(radar, sensing::Conversion::predicted, Eigen::Vector3d(54e3, 0.9, 0.4),
                                    MatrixXd(sd.cwiseAbs2().asDiagonal()), place, MatrixXd(root * root.transpose()));
    CHECK((told.covariance - exact).cwiseAbs().maxCoeff() < 1e-5 * exact.maxCoeff());
}

TEST_CASE(
    "far away and with coarse bearings errors are those told, and the range has no bias, by predicted covariances",
    "[converted]") {
    // A target 100 km away, known to 5 km on each axis, seen 100 times to 50 m and 3 degrees, in 200 runs.
    constexpr int runs = 200, looks = 100;
    const double sr = 50, sa = 3 * degree;
    const Eigen::Matrix2d noise = Eigen::Vector2d(sr * sr, sa * sa).asDiagonal();
    MatrixXd known = MatrixXd::Zero(4, 4);
    known.diagonal() << 25e6, 25e6, 100, 100;
    struct Result {
        double bias = 0, error = 0, nees = 0;
    };
    const auto simulated = [&](const Filters& filters, const EstimatorUnderTest& by) {
        std::mt19937_64 engine(11);
        std::normal_distribution<double> normal;
        Result out;
        double square = 0;
        for (int run = 0; run < runs; ++run) {
            Eigen::Vector4d truth(80e3, 60e3, 1, -2), start = truth;
            for (int k = 0; k < 4; ++k) start(k) += std::sqrt(known(k, k)) * normal(engine);
            Batch record = by.record_of(start, known);
            for (int k = 0; k < looks; ++k) {
                truth.head(2) += truth.tail(2);
                record = filters.predict(record, 1);
                const double r = truth.head(2).norm() + sr * normal(engine);
                const double a = std::atan2(truth(1), truth(0)) + sa * normal(engine);
                record = Filters::update(by, record, Eigen::Vector2d(r, a), noise).record;
            }
            const auto [mean, covariance] = filters.moments(record);
            const double off = mean.head(2).norm() - truth.head(2).norm();
            out.bias += off / runs;
            square += off * off / runs;
            const Eigen::Vector4d error = mean - truth;
            out.nees += error.dot(covariance.inverse() * error) / (4.0 * runs);
        }
        out.error = std::sqrt((square - out.bias * out.bias) / runs);  // of the mean
        return out;
    };
    const Filters now("2", "polar", {}, "predicted", "1e-6"), then("2", "polar", {}, "measured", "1e-6");
    const Instance direct("estimator", "kalman", {}, {{"motion", "", &now.motion}, {"sensors", "radar", &now.sensor}});
    // Records of the Kalman filter are the same, whoever holds it.
    const Result predicted = simulated(now, now.filter), measured = simulated(then, then.filter),
                 linearised = simulated(now, EstimatorUnderTest(direct));
    INFO("predicted " << predicted.bias << " +- " << predicted.error << " m, NEES " << predicted.nees << "; measured "
                      << measured.bias << " +- " << measured.error << " m, NEES " << measured.nees
                      << "; linearised NEES " << linearised.nees);
    CHECK(std::fabs(predicted.bias) < 4 * predicted.error);
    CHECK(std::fabs(measured.bias) > 10 * measured.error);
    // 4 x 200 degrees of freedom: chi-square over its mean is 1 +- 0.05; four deviations.
    CHECK(predicted.nees == Approx(1).margin(0.2));
    CHECK(measured.nees > 1.5);
    CHECK(linearised.nees > 1.5);
}

TEST_CASE("a sensor of positions is converted into the filter's own update", "[converted]") {
    // The radar's coordinates count from its mount, the filter's do not.
    const Filters filters("3", "position", {{"position", "[100, -200, 50]"}});
    const MatrixXd p = VectorXd(Eigen::VectorXd::LinSpaced(6, 9, 4)).asDiagonal(),
                   noise = Eigen::Vector3d(1, 4, 9).asDiagonal();
    VectorXd x(6), z(3);
    x << 1000, 2000, 3000, 10, 20, 30;
    z << 903, 2198, 2951;
    const Batch record = filters.filter.record_of(x, p);
    const auto told = filters.update(record, z, noise);
    const auto expected = Filters::update(filters.kalman, record, VectorXd(z + Eigen::Vector3d(100, -200, 50)), noise);
    CHECK(relative(filters.moments(told.record).first, filters.moments(expected.record).first) < 1e-13);
    CHECK(covariance_difference(filters.moments(told.record).second, filters.moments(expected.record).second) < 1e-12);
    CHECK(told.log_likelihood == Approx(expected.log_likelihood).epsilon(1e-12));
    CHECK((told.innovation - expected.innovation).norm() < 1e-10);
    CHECK(relative(told.covariance, expected.covariance) < 1e-13);
}

TEST_CASE("a prediction is seen by a converted sensor as by the sensor itself", "[converted]") {
    const Filters filters("3", "spherical", {});
    const Instance direct("estimator", "kalman", {},
                          {{"motion", "", &filters.motion}, {"sensors", "radar", &filters.sensor}});
    const EstimatorUnderTest kalman(direct);
    VectorXd x(6);
    x << 10e3, 20e3, 5e3, 10, 20, 30;
    MatrixXd root = 10 * MatrixXd::Identity(6, 6);
    root(3, 0) = 4;
    root(4, 2) = -3;
    const MatrixXd p = root * root.transpose();
    Call call;
    Batch z(3, 1), s(3, 3), cross(6, 3), cartesian(6, 3), z2(3, 1), s2(3, 3), cross2(6, 3), cartesian2(6, 3);
    REQUIRE(filters.filter.project(call, 0, filters.filter.record_of(x, p), z, s, cross, &cartesian) == PLR_OK);
    REQUIRE(kalman.project(call, 0, kalman.record_of(x, p), z2, s2, cross2, &cartesian2) == PLR_OK);
    CHECK(z[0] == z2[0]);
    CHECK(covariance_difference(s[0], s2[0]) < 1e-12);
    for (int m = 0; m < 3; ++m) {
        CHECK(relative(cross[0].col(m), cross2[0].col(m)) < 1e-12);
        CHECK(relative(cartesian[0].col(m), cartesian2[0].col(m)) < 1e-12);
    }
}

TEST_CASE("the likelihood of a converted measurement is a density over measurements", "[converted]") {
    const Filters filters("2", "polar", {});
    const Eigen::Vector2d sd(30, 2 * degree);
    const MatrixXd noise = sd.cwiseAbs2().asDiagonal();
    VectorXd x(4);
    x << 30e3, 10e3, 10, 20;
    MatrixXd p = MatrixXd::Identity(4, 4);
    p.topLeftCorner(2, 2) *= 1e4;
    const Batch record = filters.filter.record_of(x, p);
    const double range = x.head(2).norm(), azimuth = std::atan2(x(1), x(0));
    double sum = 0;
    // Steps of 15 m and 0.2 degrees, over more than eight deviations.
    for (int i = -60; i <= 60; ++i)
        for (int k = -90; k <= 90; ++k)
            sum += std::exp(filters.update(record, Eigen::Vector2d(range + 15 * i, azimuth + 0.2 * k * degree), noise)
                                .log_likelihood) *
                   15 * 0.2 * degree;
    CHECK(sum == Approx(1).epsilon(2e-3));
}

TEST_CASE("what the filter has a sensor for is not converted", "[converted]") {
    const Instance motion("motion", "constant_velocity"), points("sensor", "position"), camera("sensor", "bearings");
    const Instance inside("estimator", "kalman", {},
                          {{"motion", "", &motion}, {"sensors", "points", &points}, {"sensors", "camera", &camera}});
    const Instance instance("estimator", "converted", {}, {{"estimator", "", &inside}, {"sensors", "camera", &camera}});
    const EstimatorUnderTest filter(instance), kalman(inside);
    VectorXd x(6);
    x << 10e3, 20e3, 5e3, 10, 20, 30;
    const Batch record = filter.record_of(x, 100 * MatrixXd::Identity(6, 6));
    const Eigen::Vector2d z(1.1, 0.23);
    const MatrixXd noise = 1e-4 * MatrixXd::Identity(2, 2);
    const auto told = Filters::update(filter, record, z, noise);
    Call call;
    Batch measured(2, 1), out(kalman.record_size(), 1);
    measured[0] = z;
    EstimatorUnderTest::Told expected(2, 1);
    REQUIRE(kalman.update(call, 1, record, measured, pelorus::const_view(noise), out, expected) == PLR_OK);
    CHECK(told.record.numbers == out.numbers);
    CHECK(told.log_likelihood == expected.log_likelihood[0](0));
}

TEST_CASE("what cannot be converted is refused", "[converted]") {
    const Instance motion("motion", "constant_velocity"), points("sensor", "position"), radar("sensor", "spherical"),
        rates("sensor", "spherical_rate");
    const Instance inside("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "points", &points}});
    const Instance direct("estimator", "kalman", {}, {{"motion", "", &motion}, {"sensors", "other", &radar}});
    CHECK_THROWS_WITH(
        Instance("estimator", "converted", {}, {{"estimator", "", &inside}, {"sensors", "radar", &rates}}),
        "radar (sensor.spherical_rate) cannot be converted: a measurement (range [m], range_rate [m/s], azimuth [rad], "
        "elevation [rad]) does not tell just what the sensor looks at; give the filter a sensor of that name, which "
        "takes it as it is");
    CHECK_THROWS_WITH(
        Instance("estimator", "converted", {}, {{"estimator", "", &direct}, {"sensors", "radar", &radar}}),
        "has no linear sensor of position.x [m], position.y [m], position.z [m], into which radar (sensor.spherical) "
        "is "
        "converted: sensor.position is one");
}
