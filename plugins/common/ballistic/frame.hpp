/// The axes in which a free flight is told, and the Earth as these see it: parameters that all plugins of free flights share.
#pragma once

#include <optional>
#include <vector>

#include <pelorus/describe.hpp>

#include "earth.hpp"

namespace ballistic {

enum class Axes { flat, enu, ned, ecef };
enum class Gravity { none, constant, point, j2 };

inline constexpr double standard_gravity = 9.80665;  // m/s2, CGPM 1901

struct FrameParameters {
    Axes axes = Axes::flat;
    std::optional<std::vector<double>> origin;  // rad, rad, m
    std::optional<Gravity> gravity;
};

/// Throws where a parameter is given that the choices leave without a meaning.
inline void refuse(bool given, const char* parameter, const char* reason) {
    if (given) throw pelorus::ParameterError(parameter, reason);
}

/// Declares `axes`, `origin` and `gravity`.
template <class Plugin> void describe_frame(pelorus::Describe<Plugin>& plugin, const char* axes) {
    plugin.parameter("axes", &FrameParameters::axes)
        .initially(axes)
        .choices({{"flat", "z up from a ground that neither curves nor turns"},
                  {"enu", "east, north, up at origin, turning with the Earth"},
                  {"ned", "north, east, down at origin, turning with the Earth"},
                  {"ecef", "from the Earth's centre, x through Greenwich, z through the north pole"}})
        .doc("the axes of the state");
    plugin.parameter("origin", &FrameParameters::origin)
        .unit("rad, rad, m")
        .rows(3, 3)
        .doc("latitude, longitude and height (WGS84) of the origin of enu and ned");
    plugin.parameter("gravity", &FrameParameters::gravity)
        .choices({{"none", ""},
                  {"constant", "9.80665 m/s2 down, axes flat only"},
                  {"point", "of a point in the Earth's centre"},
                  {"j2", "with the Earth's flattening"}})
        .doc("constant in axes flat and j2 in the others if absent");
}

/// The Earth as the frame sees it. Throws ParameterError.
inline Earth earth_of(const FrameParameters& p) {
    Earth earth;
    const Gravity gravity = p.gravity.value_or(p.axes == Axes::flat ? Gravity::constant : Gravity::j2);
    if (p.axes == Axes::flat) {
        refuse(p.origin.has_value(), "origin", "belongs to axes: enu and axes: ned; flat has none");
        if (gravity == Gravity::point || gravity == Gravity::j2)
            throw pelorus::ParameterError("gravity", "is none or constant in axes: flat, which has no centre");
        if (gravity == Gravity::constant) earth.constant = {0.0, 0.0, -standard_gravity};
        return earth;
    }
    if (gravity == Gravity::constant)
        throw pelorus::ParameterError("gravity", "constant belongs to axes: flat; elsewhere it is none, point or j2");
    earth.rate = wgs84::rotation_rate;
    if (gravity != Gravity::none) earth.gravity = wgs84::gravitational_constant;
    if (gravity == Gravity::j2)
        earth.flattening_term = 1.5 * wgs84::j2 * earth.gravity * wgs84::equatorial_radius * wgs84::equatorial_radius;
    if (p.axes == Axes::ecef) {
        refuse(p.origin.has_value(), "origin",
               "belongs to axes: enu and axes: ned; that of ecef is the Earth's centre");
        return earth;
    }
    if (!p.origin)
        throw pelorus::ParameterError("origin", "is needed by axes: enu and axes: ned: latitude, longitude, height");
    const double latitude = (*p.origin)[0];
    if (!(std::fabs(latitude) <= std::acos(0.0) * (1.0 + 1e-15)))
        throw pelorus::ParameterError("origin", "has a latitude beyond the poles");
    const Vector<3> place = place_from_centre(latitude, (*p.origin)[2]);
    const double north = std::cos(latitude), up = std::sin(latitude);
    if (p.axes == Axes::enu) {
        earth.origin = place;
        earth.axis = {0.0, north, up};
    } else {
        earth.origin = {place(1), place(0), -place(2)};
        earth.axis = {north, 0.0, -up};
    }
    return earth;
}

}  // namespace ballistic
