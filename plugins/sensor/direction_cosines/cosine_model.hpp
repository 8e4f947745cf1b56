/// Range and direction cosines of an array that stands in its y-z plane and looks along x; lengths in m.
#pragma once

#include <cmath>

#include <pelorus/failure.hpp>
#include <pelorus/matrix.hpp>
#include <pelorus/small_matrix.hpp>

namespace cosines {

using pelorus::Matrix;
using pelorus::Vector;

/// (range, u, v) of a point along the array's axes; at the array itself all are 0.
inline Vector<3> seen(const Vector<3>& p) {
    const double range = p.stableNorm();
    if (range == 0.0) return Vector<3>::Zero();
    return {range, p(1) / range, p(2) / range};
}

/// d (range, u, v) / d p. Throws NumericError at the array's position.
inline Matrix<3> jacobian(const Vector<3>& p) {
    const double range = p.stableNorm();
    if (!(range > 0.0))
        throw pelorus::NumericError("the object is at the sensor's own position, where direction has no derivative");
    const Vector<3> sight = p / range;
    Matrix<3> out;
    out.row(0) = sight.transpose();
    for (const int axis : {1, 2}) {
        out.row(axis) = -sight(axis) / range * sight.transpose();
        out(axis, axis) += 1.0 / range;
    }
    return out;
}

struct Converted {
    Vector<3> mean;
    Matrix<3> covariance;
};

/// The point in front of the array that a measurement (range, u, v) with normal errors tells, without bias to second order, and
/// the moments of its error to second order, evaluated at the measurement.
///
/// r u and r v are products of independent normal errors: exact. w = sqrt(1 - u^2 - v^2) has the second derivatives
/// -(1 - v^2) / w^3, -(1 - u^2) / w^3 and -u v / w^3, whose halves times the variances are taken off the mean; a correlation of
/// range and cosines adds its covariance. The second-order part of the covariance follows Bar-Shalom, Li, Kirubarajan,
/// Estimation with Applications to Tracking and Navigation, Wiley 2001, eq. 10.3.2-13 (tr(H_i P H_j P) / 2).
/// Throws NumericError beside the array's visible half space: at |(u, v)| of 1 or more w has no value.
inline Converted unbiased(const Vector<3>& z, const Matrix<3>& noise) {
    const double r = z(0), u = z(1), v = z(2), w2 = 1.0 - u * u - v * v;
    if (!(w2 > 1e-12))
        throw pelorus::NumericError("u^2 + v^2 is not below 1: the measurement points nowhere in front of the array");
    const double w = std::sqrt(w2), w3 = w * w2;
    Matrix<3> slopes, bend[3];  // of x = r w, y = r u, z = r v
    slopes << w, -r * u / w, -r * v / w, u, r, 0.0, v, 0.0, r;
    bend[0] << 0.0, -u / w, -v / w,                        //
        -u / w, -r * (1.0 - v * v) / w3, -r * u * v / w3,  //
        -v / w, -r * u * v / w3, -r * (1.0 - u * u) / w3;
    bend[1] << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0;
    bend[2] << 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0;
    Converted out;
    out.mean << r * w, r * u, r * v;
    pelorus::small::symmetric_product(slopes, noise, out.covariance);
    Matrix<3> curved[3];
    for (int i = 0; i < 3; ++i) {
        pelorus::small::multiply(bend[i], noise, curved[i]);
        out.mean(i) -= curved[i].trace() / 2.0;
    }
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out.covariance(i, j) += curved[i].cwiseProduct(curved[j].transpose()).sum() / 2.0;  // tr(A B)
    return out;
}

}  // namespace cosines
