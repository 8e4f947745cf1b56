/// The update of a random matrix that takes the sensor's noise out of innovation and scatter.
/// Source: M. Feldmann, D. Fraenken, W. Koch, Tracking of extended objects and group targets using random matrices, IEEE
/// Transactions on Signal Processing 59(4), 2011.
#pragma once

#include "inverse_wishart.hpp"
#include "scatter.hpp"

namespace random_matrix {

/// v = v- + n, V = V- + N + Z', with N = X-^1/2 S^-1/2 e e' S^-1/2 X-^1/2 and Z' = X-^1/2 Y^-1/2 Z Y^-1/2 X-^1/2.
/// `extent` is X-, `point` Y = lambda X- + R, `covariance` S.
template <int D>
void update_feldmann(InverseWishart<D>& shape, const Matrix<D>& extent, const Matrix<D>& point,
                     const Scatter<D>& scatter, const Vector<D>& innovation, const Matrix<D>& covariance) {
    shape.degrees += scatter.number;
    shape.scale += whitened<D>(extent, covariance, innovation * innovation.transpose());
    shape.scale += whitened<D>(extent, point, scatter.sum);
    pelorus::small::symmetrise(shape.scale);
}

}  // namespace random_matrix
