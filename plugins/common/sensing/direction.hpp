/// Directions by azimuth and elevation, and how they lie in the view of something that looks along another one.
#pragma once

#include <cmath>

#include <Eigen/Geometry>
#include <pelorus/matrix.hpp>

namespace sensing {

/// Azimuth from +x to +y, elevation from the x-y plane up (rad), along some axes.
struct Direction {
    double azimuth = 0, elevation = 0;

    pelorus::Vector<3> unit() const {
        return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
    }
    static Direction of(const pelorus::Vector<3>& way) {
        return {std::atan2(way(1), way(0)), std::atan2(way(2), std::hypot(way(0), way(1)))};
    }
    template <class Archive> void state(Archive& archive) { archive(azimuth, elevation); }
};

inline double angle_between(const Direction& one, const Direction& other) {
    const pelorus::Vector<3> u = one.unit(), v = other.unit();
    return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// The direction that is reached from one to the other after `angle` (rad) along the great circle between them.
inline Direction turned(const Direction& from, const Direction& to, double angle) {
    const pelorus::Vector<3> u = from.unit(), v = to.unit();
    const double sine = u.cross(v).norm(), between = std::atan2(sine, u.dot(v));
    if (angle >= between) return to;
    if (sine < 1e-12)  // straight behind: by way of growing azimuths
        return Direction::of(std::cos(angle) * u +
                             std::sin(angle) * pelorus::Vector<3>(-std::sin(from.azimuth), std::cos(from.azimuth), 0));
    return Direction::of((std::sin(between - angle) * u + std::sin(angle) * v) / sine);
}

/// Where something lies in an upright view: angles to the left and up (rad), each seen from the view's middle; beyond a right angle
/// it lies behind.
struct Offset {
    double left = 0, up = 0;
};

inline Offset offset_in_view(const Direction& middle, const Direction& seen) {
    const pelorus::Vector<3> way = seen.unit();
    const double c = std::cos(middle.azimuth), s = std::sin(middle.azimuth), level = c * way(0) + s * way(1),
                 forward = std::cos(middle.elevation) * level + std::sin(middle.elevation) * way(2),
                 up = std::cos(middle.elevation) * way(2) - std::sin(middle.elevation) * level;
    return {std::atan2(c * way(1) - s * way(0), forward), std::atan2(up, forward)};
}

/// The direction that has this offset, less than a right angle, in the view.
inline Direction direction_in_view(const Direction& middle, const Offset& offset) {
    const double left = std::tan(offset.left), up = std::tan(offset.up), c = std::cos(middle.azimuth),
                 s = std::sin(middle.azimuth), level = std::cos(middle.elevation) - std::sin(middle.elevation) * up;
    return Direction::of(
        {c * level - s * left, s * level + c * left, std::sin(middle.elevation) + std::cos(middle.elevation) * up});
}

}  // namespace sensing
