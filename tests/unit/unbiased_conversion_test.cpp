// Range and angles as Cartesian points, against averages over normal errors by quadrature.
#include <pelorus/unbiased_conversion.hpp>

#include <catch2/catch.hpp>

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using pelorus::ConversionMoments;
using pelorus::unbiased_point;

double largest(const Eigen::MatrixXd& m) { return m.cwiseAbs().maxCoeff(); }

Vector3d plain(const Vector3d& z) {
    return z(0) * Vector3d(std::cos(z(2)) * std::cos(z(1)), std::cos(z(2)) * std::sin(z(1)), std::sin(z(2)));
}

Vector3d measured(const Vector3d& p) {
    return {p.norm(), std::atan2(p(1), p(0)), std::atan2(p(2), std::hypot(p(0), p(1)))};
}

struct Moments {
    Vector3d mean = Vector3d::Zero();
    Matrix3d square = Matrix3d::Zero();
};

/// Averages of error(e) and its squares over three independent normal errors: trapezoids, which for such a density are exact to rounding.
template <class Error> Moments average(const Vector3d& deviation, Error error) {
    Moments out;
    const double step = 0.5;
    const int reach = 16;
    const auto weight = [&](int k) {
        return step / std::sqrt(2.0 * std::acos(-1.0)) * std::exp(-0.5 * step * step * k * k);
    };
    for (int i = -reach; i <= reach; ++i)
        for (int j = -reach; j <= reach; ++j)
            for (int k = -reach; k <= reach; ++k) {
                const Vector3d e = error(step * Vector3d(i, j, k).cwiseProduct(deviation));
                const double w = weight(i) * weight(j) * weight(k);
                out.mean += w * e;
                out.square += w * e * e.transpose();
            }
    return out;
}

const Vector3d place(70e3, 70e3, 20e3);

Matrix3d noise_of(const Vector3d& deviation) { return deviation.cwiseAbs2().asDiagonal(); }

}  // namespace

TEST_CASE("unbiased conversion: the covariance at (70, 70, 20) km is the known one", "[conversion]") {
    const auto converted = unbiased_point(measured(place), noise_of({50.0, 0.8725e-3, 0.8725e-3}));
    Matrix3d expected;
    expected << 5083.391, -2376.922, -722.621, -2376.922, 5083.391, -722.621, -722.621, -722.621, 7558.352;
    CHECK(largest(converted.covariance - expected) < 6e-4);  // told to a thousandth
    CHECK(largest(converted.mean - place) < 0.08);
}

TEST_CASE("unbiased conversion: at angle errors of 2.5 degrees bias is gone and second moments are exact",
          "[conversion]") {
    const double angle = 2.5 * std::acos(-1.0) / 180.0;
    const Vector3d deviation(50.0, angle, angle), z = measured(place);
    const Matrix3d noise = noise_of(deviation);
    const Moments errors = average(
        deviation, [&](const Vector3d& e) { return Vector3d(unbiased_point(Vector3d(z + e), noise).mean - place); });
    CHECK(largest(errors.mean) < 1e-6);
    const Matrix3d told = unbiased_point(z, noise).covariance;
    CHECK(largest(errors.square - told) < 1e-9 * largest(told));

    const Moments uncorrected = average(deviation, [&](const Vector3d& e) { return Vector3d(plain(z + e) - place); });
    CHECK(largest(uncorrected.mean) == Approx(133).margin(6));  // what the correction takes away
}

TEST_CASE("unbiased conversion: nested moments are of the true place, given the measurement", "[conversion]") {
    const Vector3d deviation(50.0, 0.04, 0.03), z = measured(place);
    const Matrix3d noise = noise_of(deviation);
    const auto told = unbiased_point(z, noise, ConversionMoments::nested);
    const Moments errors = average(deviation, [&](const Vector3d& e) { return Vector3d(told.mean - plain(z - e)); });
    CHECK(largest(errors.square - told.covariance) < 1e-9 * largest(told.covariance));
    const auto exact = unbiased_point(z, noise);
    CHECK(told.mean == exact.mean);
    CHECK(largest(told.covariance - exact.covariance) < 4 * (0.04 * 0.04 + 0.03 * 0.03) * largest(exact.covariance));
    CHECK(largest(told.covariance - exact.covariance) > 1e-4 * largest(exact.covariance));
}

TEST_CASE("unbiased conversion: in the plane it is that of elevation 0", "[conversion]") {
    Eigen::Matrix2d noise;
    noise << 400.0, 0.0, 0.0, 1e-3;
    for (const ConversionMoments moments : {ConversionMoments::exact, ConversionMoments::nested}) {
        const auto level = unbiased_point(Eigen::Vector2d(5000.0, 2.0), noise, moments);
        const auto space = unbiased_point(Vector3d(5000.0, 2.0, 0.0), noise_of({20.0, std::sqrt(1e-3), 0.0}), moments);
        CHECK(largest(level.mean - space.mean.head<2>()) < 1e-12 * 5000.0);
        CHECK(largest(level.covariance - space.covariance.topLeftCorner<2, 2>()) < 1e-6);
        CHECK(largest(space.covariance.row(2)) == 0.0);
    }
}
