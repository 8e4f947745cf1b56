/// Drag in an atmosphere whose density falls exponentially with height and that turns with the Earth.
/// Source: X. R. Li, V. P. Jilkov, A survey of maneuvering target tracking, part II: ballistic target models, Proc. SPIE 4473,
/// 559-581, 2001, sections 2 and 4.
#pragma once

#include "earth.hpp"

namespace ballistic {

/// Height above the ground and its gradient.
struct Height {
    double value = 0.0;  ///< m
    Vector<3> gradient = Vector<3>::UnitZ();
};

/// Height above a spheroid at r from the Earth's centre: |r| - a (1 - f sin^2), the sine that of the geocentric latitude. Within 30 m
/// of the geodetic height near the Earth, which changes the density by less than half a hundredth.
inline Height height_of(const Earth& earth, const Vector<3>& position) {
    const Vector<3> r = position + earth.origin;
    const double distance = r.norm(), held = std::max(distance, inner_radius);
    const double sine = r.dot(earth.axis) / held, depth = 2.0 * wgs84::equatorial_radius * wgs84::flattening * sine;
    const Vector<3> up = r / held;
    Height height;
    height.value = distance - wgs84::equatorial_radius * (1.0 - wgs84::flattening * sine * sine);
    height.gradient = up + depth / held * earth.axis;
    if (distance >= inner_radius) height.gradient -= depth * sine / held * up;
    return height;
}

/// A density and how it changes with height.
struct Density {
    double value, slope;  ///< kg/m3, kg/m4
};

/// rho = rho_0 exp(-h / H); below height 0, where there is no air, rho_0 (2 - exp(h / H)), which goes on smoothly and is bounded.
inline Density density_at(double height, double at_sea_level, double scale_height) {
    const double falling = at_sea_level * std::exp(-std::fabs(height) / scale_height);
    return {height >= 0.0 ? falling : 2.0 * at_sea_level - falling, -falling / scale_height};
}

/// a = -rho/2 alpha |v| v for the drag parameter alpha = C_D A / m (m2/kg), velocity relative to the air.
inline Vector<3> drag(double density, double drag_parameter, const Vector<3>& velocity) {
    return -0.5 * density * drag_parameter * velocity.norm() * velocity;
}

/// The same with its derivatives.
inline Acceleration drag_with_gradient(const Density& density, const Height& height, double drag_parameter,
                                       const Vector<3>& velocity) {
    const double speed = velocity.norm(), factor = -0.5 * drag_parameter;
    Acceleration a;
    a.value = factor * density.value * speed * velocity;
    a.by_position = factor * density.slope * speed * velocity * height.gradient.transpose();
    if (speed > 0.0) a.by_velocity = factor * density.value / speed * velocity * velocity.transpose();
    a.by_velocity.diagonal().array() += factor * density.value * speed;
    return a;
}

}  // namespace ballistic
