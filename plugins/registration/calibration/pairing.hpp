/// Which measurements of the fast sensor are of the target that the reference has fixed, and what they tell of its time.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "local_fit.hpp"
#include "sensor_model.hpp"

namespace calibration {

/// One measurement of the sensor to be calibrated.
struct Sample {
    std::uint64_t id = 0;
    std::int64_t time = 0;      ///< ns, its stamp
    Eigen::VectorXd value;      ///< m
    Eigen::VectorXd variances;  ///< m
    template <class Archive> void state(Archive& archive) { archive(id, time, value, variances); }
};

/// One scan of it.
struct Frame {
    std::int64_t time = 0;  ///< ns
    std::vector<Sample> samples;
    template <class Archive> void state(Archive& archive) { archive(time, samples); }
};

/// One measurement of the reference, in Cartesian coordinates.
struct Fix {
    std::uint64_t id = 0;
    std::int64_t time = 0;       ///< ns
    Eigen::Vector3d position;    ///< m
    Eigen::Matrix3d covariance;  ///< m2
    template <class Archive> void state(Archive& archive) { archive(id, time, position, covariance); }
};

struct PairingRule {
    std::int64_t window = 0;   ///< ns, of frames around a fix
    double gate = 0;           ///< deviations
    double maximum_speed = 0;  ///< m/s
};

/// A fix and what the sensor measured of the same target at the same time.
struct Pair {
    Eigen::VectorXd difference;  ///< measured - expected with the biases' mean
    Eigen::MatrixXd noise;       ///< of that, the biases apart
    BiasSlope slope;             ///< of what is expected; the clock's is shrunk where the rate is not told from 0
    Eigen::MatrixXd covariance;  ///< noise and what is not known of the biases
};

/// The sensor, how it stands, and what is believed of it.
struct Believed {
    const SensorModel& sensor;
    Pose pose;
    const Biases& biases;
};

/// Nothing where no frames surround the fix, where more than one target could be meant, or where the measurements do not lie on
/// a parabola. `fixes` are all of the scan; fixes[index] is meant. `shared`: how many fixes use the same frames.
std::optional<Pair> pair_up(pelorus::Caller& caller, const Believed& believed, const PairingRule& rule,
                            const std::deque<Frame>& frames, const std::vector<Fix>& fixes, std::size_t index,
                            double shared);

}  // namespace calibration
