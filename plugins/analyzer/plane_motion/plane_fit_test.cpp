#include "plane_fit.hpp"

#include <catch2/catch.hpp>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <pelorus/unbiased_conversion.hpp>

#include "../../../tests/support/reference.hpp"

namespace {

using namespace plane_motion;
using test_support::matrix;
using test_support::reference;
using Points = std::deque<Sample>;

Samples all(const Points& points) { return {points.begin(), points.end()}; }

/// The points of tests/reference/plane_test_cases.json, converted from their measurements.
Points reference_points() {
    const auto answers = reference("plane_test_cases.json");
    const Eigen::VectorXd sigma = matrix(answers.at("sigma")), r = matrix(answers.at("r"));
    const Eigen::VectorXd el = matrix(answers.at("el")), az = matrix(answers.at("az"));
    const Matrix<3> noise = Vector<3>(sigma(0), sigma(2), sigma(1)).cwiseAbs2().asDiagonal();
    Points out;
    for (Eigen::Index i = 0; i < r.size(); ++i) {
        const auto point = pelorus::unbiased_point(Vector<3>(r(i), az(i), el(i)), noise);
        out.push_back({i, point.mean, point.covariance});
    }
    return out;
}

Points noisy(const Points& points, unsigned seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal;
    Points out = points;
    for (Sample& sample : out) {
        const Matrix<3> root = sample.covariance.llt().matrixL();
        sample.point += root * Vector<3>(normal(engine), normal(engine), normal(engine));
    }
    return out;
}

/// A circle in a plane through (9, 8, 7) km, with errors that differ from point to point.
Points circle(int count) {
    const Vector<3> a = Vector<3>(1, 2, 3).normalized(), b = a.cross(Vector<3>(0, 0, 1)).normalized();
    Points out;
    for (int k = 0; k < count; ++k) {
        const double t = 0.1 * k;
        Matrix<3> covariance;
        covariance << 900, 100 * std::sin(t), 50, 100 * std::sin(t), 400 + 10 * k, -90, 50, -90, 1600;
        out.push_back({k, Vector<3>(9e3, 8e3, 7e3) + 3e3 * (std::cos(t) * a + std::sin(t) * b), covariance});
    }
    return out;
}

Points line(int count) {
    Points out = circle(count);
    for (int k = 0; k < count; ++k)
        out[static_cast<std::size_t>(k)].point = Vector<3>(9e3 + 100 * k, 8e3 - 50 * k, 7e3 + 9 * k);
    return out;
}

double sum_for(const Points& points, const Vector<3>& normal, double offset) {
    double sum = 0;
    for (const Sample& s : points) sum += std::pow(normal.dot(s.point) - offset, 2) / normal.dot(s.covariance * normal);
    return sum;
}

}  // namespace

TEST_CASE("plane fit: the known statistics of twenty measurements come out", "[plane_motion]") {
    const auto answers = reference("plane_test_cases.json");
    const Points points = reference_points();
    const Samples samples = all(points);
    const char* const names[] = {"x|yz", "y|xz", "z|xy"};
    for (int k = 0; k < 3; ++k)
        CHECK(regression_on(samples, k).statistic ==
              Approx(answers.at("stat").at(names[k]).get<double>()).epsilon(1e-6));
    CHECK(regression(samples).statistic == regression_on(samples, 0).statistic);

    const Fit fit = errors_in_variables(samples);
    CHECK(fit.status == Status::tested);
    CHECK(fit.statistic == Approx(answers.at("eiv").get<double>()).epsilon(1e-6));
    CHECK(fit.degrees_of_freedom == answers.at("dof").get<int>());
    const Eigen::VectorXd normal = matrix(answers.at("eiv_normal_up_to_sign"));
    CHECK((fit.normal.cross(Vector<3>(normal))).norm() < 1e-6);
    CHECK(fit.normal.norm() == Approx(1));
    CHECK(fit.normal(0) > 0);  // the largest component
}

TEST_CASE("plane fit: errors in variables finds the least sum there is", "[plane_motion]") {
    std::mt19937_64 engine(3);
    std::normal_distribution<double> normal;
    for (unsigned seed = 0; seed < 20; ++seed) {
        const Points points = noisy(circle(5 + static_cast<int>(seed) * 3), seed);
        const Fit fit = errors_in_variables(all(points));
        CHECK(sum_for(points, fit.normal, fit.offset) == Approx(fit.statistic).epsilon(1e-9));
        for (int k = 0; k < 200; ++k) {
            const double size = std::pow(10.0, -k % 6);
            const Vector<3> other =
                (fit.normal + size * Vector<3>(normal(engine), normal(engine), normal(engine))).normalized();
            double weights = 0, mean = 0;
            for (const Sample& s : points) {
                const double w = 1 / other.dot(s.covariance * other);
                weights += w;
                mean += w * other.dot(s.point);
            }
            CHECK(sum_for(points, other, mean / weights) >= fit.statistic * (1 - 1e-9));
        }
    }
}

TEST_CASE("plane fit: a plane's statistic is chi-square distributed, regression's is inflated", "[plane_motion]") {
    const Points points = circle(40);
    double sum = 0, square = 0, regressed = 0;
    const int runs = 600;
    for (unsigned seed = 0; seed < runs; ++seed) {
        const Points drawn = noisy(points, seed);
        const double statistic = errors_in_variables(all(drawn)).statistic;
        sum += statistic / runs;
        square += statistic * statistic / runs;
        regressed += regression(all(drawn)).statistic / runs;
    }
    CHECK(sum == Approx(37).margin(4 * std::sqrt(2 * 37.0 / runs)));
    CHECK(std::sqrt(square - sum * sum) == Approx(std::sqrt(2 * 37.0)).epsilon(0.1));
    CHECK(regressed > 1.3 * sum);
}

TEST_CASE("plane fit: a level or upright plane is no special case", "[plane_motion]") {
    for (int axis = 0; axis < 3; ++axis) {
        Points points = circle(30);
        for (Sample& s : points) {
            const double t = 0.1 * static_cast<double>(s.time);
            s.point = Vector<3>(9e3, 8e3, 7e3);
            s.point((axis + 1) % 3) += 2e3 * std::cos(t);
            s.point((axis + 2) % 3) += 1e3 * std::sin(t);
        }
        const Fit fit = errors_in_variables(all(points));
        CHECK((fit.normal - Vector<3>::Unit(axis)).norm() < 1e-9);
        CHECK(fit.statistic < 1e-9);
        CHECK(fit.offset == Approx(Vector<3>(9e3, 8e3, 7e3)(axis)));
        CHECK(is_tested(regression(all(points)).status));
        CHECK(regression(all(points)).statistic < 1e-6);
    }
}

TEST_CASE("plane fit: what cannot be tested has a status and no numbers", "[plane_motion]") {
    const auto status_of = [](const Points& points) {
        const Fit fit = errors_in_variables(all(points)), other = regression(all(points));
        CHECK(fit.status == other.status);
        CHECK(fit.statistic == 0);
        CHECK(fit.normal.isZero(0));
        return fit.status;
    };
    Points points = circle(30);
    CHECK(status_of({}) == Status::few_points);
    CHECK(status_of(circle(3)) == Status::few_points);
    for (std::size_t k = 3; k < points.size(); ++k) points[k].point = points[k % 3].point;
    CHECK(status_of(points) == Status::repeated);
    for (Sample& s : points) s.point = points.front().point;
    CHECK(status_of(points) == Status::repeated);
    points = circle(30);
    points[7].covariance.setZero();
    CHECK(status_of(points) == Status::no_variance);
    points = circle(30);
    for (Sample& s : points) s.point *= 1e200;
    CHECK(status_of(points) == Status::out_of_range);
}

TEST_CASE("plane fit: points on a line are seen to be on one, and are in a plane", "[plane_motion]") {
    const Points exact = line(40);
    CHECK(line_statistic(all(exact)) < 1e-6);
    CHECK(errors_in_variables(all(exact)).statistic < 1e-6);
    CHECK(is_tested(regression(all(exact)).status));
    double sum = 0, planes = 0;
    const int runs = 300;
    for (unsigned seed = 0; seed < runs; ++seed) {
        const Points drawn = noisy(exact, seed);
        sum += line_statistic(all(drawn)) / runs;
        planes += errors_in_variables(all(drawn)).statistic / runs;
    }
    CHECK(sum == Approx(76).margin(4 * std::sqrt(2 * 76.0 / runs)));  // 2 points - 4
    CHECK(planes < 36);                                               // points - 3 is 37: conservative
    CHECK(line_statistic(all(circle(40))) > 1e6);
}
