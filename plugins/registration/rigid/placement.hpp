/// How one set of axes stands among others, and what that does to points.
#pragma once

#include <optional>
#include <vector>

#include <pelorus/describe.hpp>

namespace rigid {

using pelorus::Matrix;
using pelorus::Vector;

/// p' = R p + t: a point of the old axes, seen along the new ones (m). R is a rotation: a 3 x 3 matrix, R R' = 1, det R = 1.
struct Motion {
    Matrix<3> rotation = Matrix<3>::Identity();
    Vector<3> translation = Vector<3>::Zero();

    Vector<3> operator()(const Vector<3>& point) const { return rotation * point + translation; }
    /// The way back.
    Motion inverse() const;
    /// Whether z stays z and nothing of it mixes with x and y: then the motion is one of the plane, too.
    bool keeps_the_plane() const;
};

/// Rz(yaw) Ry(pitch) Rx(roll) of an attitude (roll, pitch, yaw; rad): from coordinates along the turned axes to the others.
Matrix<3> rotation_of_attitude(const Vector<3>& attitude);

/// The same of a unit quaternion w, x, y, z: the vector part of q p q*.
/// Source: J. B. Kuipers, Quaternions and Rotation Sequences, Princeton University Press, 1999, section 5.14.
Matrix<3> rotation_of_quaternion(const Vector<4>& quaternion);

/// Where the described axes stand among the others, as parameters say it: on the Earth, shifted and turned. A base of the plugin.
struct Placement {
    std::optional<std::vector<double>> attitude;            ///< roll, pitch, yaw, rad
    std::optional<std::vector<double>> quaternion;          ///< w, x, y, z
    std::optional<std::vector<double>> translation;         ///< m: the described axes' origin
    std::optional<std::vector<double>> from_site, to_site;  ///< latitude, longitude (rad), height (m)

    bool is_given() const { return attitude || quaternion || translation || from_site || to_site; }
    /// From the surrounding axes into the described ones: with both sites, from east, north, up at the one into axes that are
    /// shifted and turned from east, north, up at the other. Throws ParameterError.
    Motion into() const;

    template <class Plugin> static void describe_placement(pelorus::Describe<Plugin>& plugin) {
        plugin.parameter("attitude", &Placement::attitude)
            .unit("rad")
            .rows(3, 3)
            .doc(
                "roll, pitch, yaw of the described axes: R = Rz(yaw) Ry(pitch) Rx(roll) takes their coordinates to the "
                "surrounding ones");
        plugin.parameter("quaternion", &Placement::quaternion)
            .rows(4, 4)
            .doc("the same R as w, x, y, z, instead; norm 1");
        plugin.parameter("translation", &Placement::translation)
            .unit("m")
            .rows(3, 3)
            .doc(
                "where the origin of the described axes lies among the surrounding ones; with sites, along east, "
                "north, "
                "up at `to_site`");
        plugin.parameter("from_site", &Placement::from_site)
            .unit("rad, rad, m")
            .rows(3, 3)
            .doc("latitude, longitude, height (WGS84) where the surrounding axes stand, along east, north, up");
        plugin.parameter("to_site", &Placement::to_site)
            .unit("rad, rad, m")
            .rows(3, 3)
            .doc("the same of the described axes");
    }
};

}  // namespace rigid
