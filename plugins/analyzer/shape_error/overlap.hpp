/// How much of two ellipses or ellipsoids is common to both.
#pragma once

#include <pelorus/matrix.hpp>

namespace shape_error {

/// Area of the intersection divided by that of the union of (p - c)' X^-1 (p - c) <= 1 in the plane, `offset` the difference of
/// their centres (m), extents in m^2. Exact up to rounding: the boundary of the intersection consists of at most eight arcs, whose
/// ends are the roots of a trigonometric polynomial of degree two, and Green's theorem gives the area within arcs of ellipses.
/// NaN where one of them is no ellipse.
double intersection_over_union(const pelorus::Vector<2>& offset, const pelorus::Matrix<2>& one,
                               const pelorus::Matrix<2>& other);

/// The same of volumes: the exact area common to both in 128 slices, summed by Gauss-Legendre quadrature. Always the same for the
/// same input, and right to 1e-4.
double intersection_over_union(const pelorus::Vector<3>& offset, const pelorus::Matrix<3>& one,
                               const pelorus::Matrix<3>& other);

}  // namespace shape_error
