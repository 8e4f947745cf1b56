/// A zone on the ground: a polygon in x and y.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>

/// Corners in order, one a row: x, y (m). Neighbours may not coincide.
using Corners = Eigen::MatrixXd;

/// Twice the area that the corners enclose, positive if they go round from +x towards +y.
inline double twice_area(const Corners& corners) {
    double sum = 0;
    for (Eigen::Index i = 0, last = corners.rows() - 1; i <= last; ++i) {
        const Eigen::Index next = i == last ? 0 : i + 1;
        sum += corners(i, 0) * corners(next, 1) - corners(next, 0) * corners(i, 1);
    }
    return sum;
}

/// How far (x, y) is outside the zone; negative inside, 0 on its edge. Not a number stays that.
inline double distance_outside(const Corners& corners, double x, double y) {
    double square = std::numeric_limits<double>::infinity();
    bool inside = false;
    for (Eigen::Index i = 0, last = corners.rows() - 1; i <= last; ++i) {
        const Eigen::Index next = i == last ? 0 : i + 1;
        const double ax = corners(i, 0), ay = corners(i, 1), bx = corners(next, 0), by = corners(next, 1);
        const double ux = bx - ax, uy = by - ay;
        const double along = std::clamp(((x - ax) * ux + (y - ay) * uy) / (ux * ux + uy * uy), 0.0, 1.0);
        const double dx = x - (ax + along * ux), dy = y - (ay + along * uy);
        square = std::min(square, dx * dx + dy * dy);
        // A ray towards +x crosses the edges of the zone an odd number of times if it begins inside.
        if ((ay > y) != (by > y) && x < ax + (y - ay) / uy * ux) inside = !inside;
    }
    const double distance = std::sqrt(square);
    return std::isnan(x + y) ? x + y : inside ? -distance : distance;
}
