/// The Earth as a free flight feels it: gravity with its flattening, and the forces of a frame that turns with it.
/// Lengths in m, times in s, accelerations in m/s2. All functions are pure: [worker, concurrent] [hot].
/// Sources: O. Montenbruck, E. Gill, Satellite Orbits, Springer 2000, 3.2 (J2); National Imagery and Mapping Agency, Department of
/// Defense World Geodetic System 1984, TR8350.2, 3rd edition, 2000 (constants); J2 = 1.08262668e-3 is that of EGM96.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <pelorus/matrix.hpp>

namespace ballistic {

using pelorus::Matrix;
using pelorus::Vector;

namespace wgs84 {
inline constexpr double gravitational_constant = 3.986004418e14;  // m3/s2, of the Earth and its atmosphere
inline constexpr double equatorial_radius = 6378137.0;            // m
inline constexpr double flattening = 1.0 / 298.257223563;
inline constexpr double rotation_rate = 7.292115e-5;  // rad/s
inline constexpr double j2 = 1.08262668e-3;
}  // namespace wgs84

/// Within this distance (m) of the Earth's centre, below any ground, gravity falls to 0 as in a ball of even density, so that a
/// filter that strays there gets finite answers.
inline constexpr double inner_radius = 6.3e6;

/// An acceleration and how it changes with position and velocity.
struct Acceleration {
    Vector<3> value = Vector<3>::Zero();
    Matrix<3> by_position = Matrix<3>::Zero(), by_velocity = Matrix<3>::Zero();
};

/// The Earth seen from a frame that turns with it.
struct Earth {
    Vector<3> origin = Vector<3>::Zero();    ///< from the Earth's centre to the frame's origin, m
    Vector<3> axis = Vector<3>::UnitZ();     ///< unit vector of the rotation
    double gravity = 0.0;                    ///< m3/s2, 0: none
    double flattening_term = 0.0;            ///< 1.5 J2 gravity Re^2, 0: a point or none
    double rate = 0.0;                       ///< rad/s, 0: the frame does not turn
    Vector<3> constant = Vector<3>::Zero();  ///< further acceleration, the same everywhere, m/s2

    /// Adds gravity, Coriolis and centrifugal acceleration at a position and velocity of the frame:
    /// a = -mu/r^3 (r (1 + c (1 - 5 s^2/r^2)) + 2 c s axis) - 2 w x v - w x (w x r), c = 1.5 J2 (Re/r)^2, s = r . axis.
    Vector<3> acceleration(const Vector<3>& position, const Vector<3>& velocity) const {
        const Vector<3> r = position + origin;
        const Terms t(*this, r);
        return constant + t.along * r + t.polar * axis + turning(r, velocity);
    }
    /// The same with its derivatives.
    Acceleration with_gradient(const Vector<3>& position, const Vector<3>& velocity) const {
        const Vector<3> r = position + origin;
        const Terms t(*this, r);
        Acceleration a;
        a.value = constant + t.along * r + t.polar * axis + turning(r, velocity);
        // d along / d r and d polar / d r; in the inner ball the distance is held.
        const double held = t.inside ? 0.0 : 1.0;
        const double i5 = t.inverse_cube * t.inverse_square, i7 = i5 * t.inverse_square;
        const Vector<3> along_gradient =
            held * (3.0 * gravity * i5 + flattening_term * (5.0 * i7 - 35.0 * t.s * t.s * i7 * t.inverse_square)) * r +
            10.0 * flattening_term * t.s * i7 * axis;
        const Vector<3> polar_gradient = -2.0 * flattening_term * (i5 * axis - held * 5.0 * t.s * i7 * r);
        // -w x (w x r) = w^2 (r - axis axis' r).
        a.by_position =
            r * along_gradient.transpose() + axis * polar_gradient.transpose() - rate * rate * axis * axis.transpose();
        a.by_position.diagonal().array() += t.along + rate * rate;
        a.by_velocity << 0.0, axis(2), -axis(1), -axis(2), 0.0, axis(0), axis(1), -axis(0), 0.0;  // -axis x .
        a.by_velocity *= 2.0 * rate;
        return a;
    }

private:
    /// Gravity as along * r + polar * axis.
    struct Terms {
        Terms(const Earth& earth, const Vector<3>& r) : s(r.dot(earth.axis)) {
            const double distance = r.norm();
            inside = distance < inner_radius;
            const double inverse = 1.0 / std::max(distance, inner_radius);
            inverse_square = inverse * inverse;
            inverse_cube = inverse_square * inverse;
            const double i5 = inverse_cube * inverse_square;
            along = -earth.gravity * inverse_cube - earth.flattening_term * i5 * (1.0 - 5.0 * s * s * inverse_square);
            polar = -2.0 * earth.flattening_term * s * i5;
        }
        double s, along, polar, inverse_square, inverse_cube;
        bool inside;
    };
    Vector<3> turning(const Vector<3>& r, const Vector<3>& velocity) const {
        return rate * (rate * (r - r.dot(axis) * axis) - 2.0 * axis.cross(velocity));
    }
};

/// From the Earth's centre to a place, in the axes east, north, up there. Latitude in rad, height in m above the ellipsoid.
inline Vector<3> place_from_centre(double latitude, double height) {
    const double square = wgs84::flattening * (2.0 - wgs84::flattening);  // first eccentricity squared
    const double sine = std::sin(latitude), root = std::sqrt(1.0 - square * sine * sine);
    return {0.0, -square * wgs84::equatorial_radius / root * sine * std::cos(latitude),
            wgs84::equatorial_radius * root + height};
}

}  // namespace ballistic
