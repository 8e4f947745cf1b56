/// Where and how a sensor stands: a mount given by parameters, on a platform whose pose may be given by inputs. Another input tells by
/// how much the mount stands turned against its parameters, about the sensor's own axes:
///     R = platform * mount * error,   p = platform * position + platform_position
///
/// Lengths in m, velocities in m/s, angles in rad, along the axes of the frame in which the sensor is used. A platform that
/// is not told of stands still at the origin, along the axes of the frame.
#pragma once

#include <string>

#include <pelorus/describe.hpp>
#include <pelorus/matrix.hpp>
#include <pelorus/small_matrix.hpp>

#include "spherical_model.hpp"

namespace sensing {

using pelorus::Matrix;
using pelorus::Vector;

template <int D> constexpr int attitude_size = D == 2 ? 1 : 3;

/// From coordinates along the turned axes to those of the frame: in the plane by yaw, in space by roll, pitch, yaw.
template <int D> Matrix<D> rotation(const double* attitude) {
    if constexpr (D == 2) {
        const double c = std::cos(attitude[0]), s = std::sin(attitude[0]);
        Matrix<2> r;
        r << c, -s, s, c;
        return r;
    } else {
        return spherical::rotation(attitude[0], attitude[1], attitude[2]);
    }
}

template <int D> struct Pose {
    Matrix<D> rotation;  ///< along the sensor's axes -> along the frame's
    Vector<D> position, velocity;
};

template <int D> struct MountParameters {
    Vector<D> position = Vector<D>::Zero(), velocity = Vector<D>::Zero();
    Vector<attitude_size<D>> attitude = Vector<attitude_size<D>>::Zero();

    /// The parameters, and the inputs in the order position, attitude, velocity, error. Velocities only where the sensor measures a rate.
    template <class Plugin> static void describe_mount(pelorus::Describe<Plugin>& plugin, bool with_velocity) {
        const char* const zeros = D == 2 ? "[0 m, 0 m]" : "[0 m, 0 m, 0 m]";
        plugin.parameter("position", &MountParameters::position)
            .unit("m")
            .initially(zeros)
            .doc("where the sensor stands; along the platform's axes, from its position, where it is told of");
        plugin.parameter(D == 2 ? "yaw" : "attitude", &MountParameters::attitude)
            .unit("rad")
            .initially(D == 2 ? "[0 rad]" : "[0 rad, 0 rad, 0 rad]")
            .doc(D == 2 ? "how far the sensor is turned from +x to +y"
                        : "roll, pitch, yaw of its mount: R = Rz(yaw) Ry(pitch) Rx(roll), right-handed");
        plugin.input("platform_position", "m", std::vector<double>(D, 0.0), "where the platform of the sensor is");
        plugin.input(D == 2 ? "platform_yaw" : "platform_attitude", "rad", std::vector<double>(attitude_size<D>, 0.0),
                     D == 2 ? "how far the platform is turned from +x to +y" : "roll, pitch, yaw of the platform");
        if (with_velocity) {
            plugin.parameter("velocity", &MountParameters::velocity)
                .unit("m/s")
                .initially(D == 2 ? "[0 m/s, 0 m/s]" : "[0 m/s, 0 m/s, 0 m/s]")
                .doc("the sensor's own velocity, which range rates are counted from; it does not move `position`");
            plugin.input("platform_velocity", "m/s", std::vector<double>(D, 0.0), "velocity of the platform");
        }
        plugin.input(
            "attitude_error", "rad", std::vector<double>(attitude_size<D>, 0.0),
            D == 2 ? "how far the mount is turned beyond its yaw"
                   : "roll, pitch, yaw about the sensor's own axes by which the mount is turned beyond its attitude");
    }
};

/// Answers the pose of a call. Immutable after creation.
template <int D> class Mount {
public:
    Mount() = default;
    explicit Mount(const MountParameters<D>& given)
        : resting_{rotation<D>(given.attitude.data()), given.position, given.velocity} {}

    /// With the values of the inputs; `velocity` is nullptr where the sensor has no such input.
    Pose<D> pose(const double* position, const double* attitude, const double* error, const double* velocity) const {
        Pose<D> out = resting_;
        if (is_turned(error)) pelorus::small::multiply(resting_.rotation, rotation<D>(error), out.rotation);
        if (is_turned(attitude)) {
            const Matrix<D> platform = rotation<D>(attitude), mount = out.rotation;
            pelorus::small::multiply(platform, mount, out.rotation);
            pelorus::small::multiply(platform, resting_.position, out.position);
            pelorus::small::multiply(platform, resting_.velocity, out.velocity);
        }
        out.position += Eigen::Map<const Vector<D>>(position);
        if (velocity != nullptr) out.velocity += Eigen::Map<const Vector<D>>(velocity);
        return out;
    }

private:
    static bool is_turned(const double* attitude) {
        bool turned = false;
        for (int k = 0; k < attitude_size<D>; ++k) turned = turned || attitude[k] != 0.0;
        return turned;
    }

    Pose<D> resting_;
};

}  // namespace sensing
