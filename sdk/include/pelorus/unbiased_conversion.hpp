/// Measurements of range and angles as Cartesian points, without bias and with the covariance of their errors.
///
///     const pelorus::ConvertedPoint<3> point = pelorus::unbiased_point(z, noise);   // z: range, azimuth, elevation
///     const pelorus::ConvertedPoint<2> level = pelorus::unbiased_point(z2, noise2); // z2: range, azimuth
///
/// Azimuth runs from +x to +y, elevation from the x-y plane to +z; lengths in m, angles in rad; points are along the sensor's axes.
#pragma once

#include <cmath>

#include <pelorus/matrix.hpp>
#include <pelorus/small_matrix.hpp>

namespace pelorus {

template <int Axes> struct ConvertedPoint {
    Vector<Axes> mean;        ///< m
    Matrix<Axes> covariance;  ///< m^2
};

/// Which second moments the covariance of a converted point holds. Both are evaluated at the measurement, and differ by what is of
/// second order in the variances of the angles.
enum class ConversionMoments {
    exact,   ///< of the converted point about a given true place
    nested,  ///< of the true place about the converted point, given the measurement
};

/// d (x, y, z) / d (range, azimuth, elevation).
inline Matrix<3> conversion_slope(const Vector<3>& z) {
    const double r = z(0), ca = std::cos(z(1)), sa = std::sin(z(1)), ce = std::cos(z(2)), se = std::sin(z(2));
    Matrix<3> out;
    out << ce * ca, -r * ce * sa, -r * se * ca,  //
        ce * sa, r * ce * ca, -r * se * sa,      //
        se, 0.0, r * ce;
    return out;
}

namespace detail {

/// A cosine and sine whose angle has a normal error: averages over it.
struct NoisyAngle {
    double cosine, sine, growth;                       ///< of the angle as measured; 1 / E cos(error)
    double cosine_square, sine_square, sine_x_cosine;  ///< averages of the products
    NoisyAngle(double angle, double variance)
        : cosine(std::cos(angle)), sine(std::sin(angle)), growth(std::exp(variance / 2.0)) {
        const double fade = std::exp(-2.0 * variance);
        const double cosine_of_double = fade * (cosine * cosine - sine * sine);
        cosine_square = (1.0 + cosine_of_double) / 2.0;
        sine_square = (1.0 - cosine_of_double) / 2.0;
        sine_x_cosine = fade * sine * cosine;
    }
};

}  // namespace detail

/// The unbiased Cartesian point of a measurement (range, azimuth, elevation) with independent normal errors, and the second
/// moments of its error. Correlations of the errors (off the diagonal of `noise`) enter to first order.
///
/// Averaged over the errors, cos and sin of an angle shrink by exp(-variance / 2): the mean is divided by that. Second moments
/// follow from E cos^2 = (1 + exp(-2 variance) cos 2 angle) / 2 and its like. With ke = exp(se^2 / 2), ka = exp(sa^2 / 2), the
/// plain conversion (x, y, h) and E the averages of products over errors about the measurement:
///     exact:   Cxx = ke^2 ka^2 E[x^2] - x^2,              Cxh = ke^2 E[r^2 sin e cos e] cos a - x h, ...
///     nested:  Cxx = E[x^2] + (ke^2 ka^2 - 2) x^2,        Cxh = E[x h] + (ke^2 ka - ka - 1/ka) x h, ...
/// Source: L. Mo, X. Song, Y. Zhou, Z. K. Sun, Y. Bar-Shalom, Unbiased converted measurements for tracking, IEEE Transactions on
/// Aerospace and Electronic Systems 34(3), 1023-1027, 1998 (the factors; nested). The exact moments are those of the corrected
/// point given the true place, without that paper's nested conditioning, which S. Bordonaro, P. Willett, Y. Bar-Shalom,
/// Decorrelated unbiased converted measurement Kalman filter, ibid. 50(2), 1431-1444, 2014, discuss.
inline ConvertedPoint<3> unbiased_point(const Vector<3>& z, const Matrix<3>& noise,
                                        ConversionMoments moments = ConversionMoments::exact) {
    const detail::NoisyAngle a(z(1), noise(1, 1)), e(z(2), noise(2, 2));
    const double x = z(0) * e.cosine * a.cosine, y = z(0) * e.cosine * a.sine, h = z(0) * e.sine;
    const double ke = e.growth, ka = a.growth, square = z(0) * z(0) + noise(0, 0);

    ConvertedPoint<3> out;
    out.mean << x * ke * ka, y * ke * ka, h * ke;
    // Averages of products of two coordinates by `level` (two of x, y), `mixed` (one of them and h) and `height` (h twice); and
    // how much of the products as measured is taken off.
    double level, mixed, height, off_level, off_mixed, off_height;
    if (moments == ConversionMoments::exact) {
        height = square * ke * ke;
        level = height * ka * ka;
        mixed = height;
        off_level = off_mixed = off_height = 1.0;
    } else {
        height = level = square;
        mixed = square / ka;
        off_level = 2.0 - ke * ke * ka * ka;
        off_mixed = ka + 1.0 / ka - ke * ke * ka;
        off_height = 2.0 - ke * ke;
    }
    const double xx = level * e.cosine_square * a.cosine_square - off_level * x * x;
    const double yy = level * e.cosine_square * a.sine_square - off_level * y * y;
    const double xy = level * e.cosine_square * a.sine_x_cosine - off_level * x * y;
    const double hh = height * e.sine_square - off_height * h * h;
    const double xh = mixed * e.sine_x_cosine * a.cosine - off_mixed * x * h;
    const double yh = mixed * e.sine_x_cosine * a.sine - off_mixed * y * h;
    out.covariance << xx, xy, xh, xy, yy, yh, xh, yh, hh;

    Matrix<3> correlated = noise;
    correlated.diagonal().setZero();
    if (!correlated.isZero(0.0)) {
        Matrix<3> share;
        small::symmetric_product(conversion_slope(z), correlated, share);
        out.covariance += share;
    }
    return out;
}

/// The same in the plane: range and azimuth, at elevation 0.
inline ConvertedPoint<2> unbiased_point(const Vector<2>& z, const Matrix<2>& noise,
                                        ConversionMoments moments = ConversionMoments::exact) {
    Matrix<3> errors = Matrix<3>::Zero();
    errors.topLeftCorner<2, 2>() = noise;
    const ConvertedPoint<3> in_space = unbiased_point(Vector<3>(z(0), z(1), 0.0), errors, moments);
    return {in_space.mean.head<2>(), in_space.covariance.topLeftCorner<2, 2>()};
}

}  // namespace pelorus
