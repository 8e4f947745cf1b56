/// The Kalman filter of nine-state tracks without Pelorus: what one writes who needs this one filter in one program. It does
/// the same arithmetic in the same steps as estimator.kalman with motion.constant_acceleration and sensor.position or
/// sensor.spherical, so that the two can be compared number by number, and their times be set against each other.
///
/// Units are SI; all calls are pure but for their outputs.
#pragma once

#include <array>
#include <cstddef>

namespace plain {

constexpr int states = 9, axes = 3, derivatives = 3, measured = 3;

struct Track {
    std::array<double, states> mean;                 ///< positions, velocities, accelerations
    std::array<double, states * states> covariance;  ///< column-major
};

struct Measurement {
    std::array<double, measured> value;
    std::array<double, measured * measured> noise;  ///< column-major
};

enum class Sensor { position, spherical };

/// A spherical sensor's mount: where it stands, and the rotation from its axes to the frame's (column-major).
struct Mount {
    std::array<double, 3> position;
    std::array<double, 9> rotation;
    std::array<double, 3> bias;
};

/// What a sensor should see of an object, and how that depends on where it is.
struct Seen {
    double predicted[measured];
    double jacobian[measured * axes];  ///< column-major
};
Seen look(Sensor sensor, const Mount& mount, const double* position);
/// measurement - predicted, angles in (-pi, pi].
void residual(Sensor sensor, const Measurement& measurement, const Seen& seen, double (&out)[measured]);

/// Constant acceleration with white jerk of density `jerk` [m2/s5], one time step `dt` for all. False where a result is
/// not finite.
bool predict(const Track* from, Track* to, std::size_t count, double dt, double jerk);

/// One measurement a track. False where a covariance is indefinite or a result is not finite.
bool update(Sensor sensor, const Mount& mount, const Track* from, const Measurement* measurements, Track* to,
            double* log_likelihood, std::size_t count);

}  // namespace plain
