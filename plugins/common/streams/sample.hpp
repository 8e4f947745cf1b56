/// One measurement of a stream that sees one object, and what all measurements of the stream have in common.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <pelorus/stage.hpp>

namespace streams {

using Clock = std::int64_t;  ///< ns

inline double seconds(Clock span) noexcept { return static_cast<double>(span) * 1e-9; }

/// A span given in seconds by a parameter. Throws ParameterError where a clock of nanoseconds cannot tell it.
inline Clock nanoseconds(const char* parameter, double given) {
    if (!(given < 4e9)) throw pelorus::ParameterError(parameter, "is not within what a clock of nanoseconds can tell");
    return std::llround(given * 1e9);
}

struct Sample {
    Clock time = 0;
    std::uint64_t id = 0;
    Eigen::VectorXd value;
    Eigen::MatrixXd covariance;
    template <class Archive> void state(Archive& archive) { archive(time, id, value, covariance); }
};

/// What a scan tells of where its numbers live: kept, because the sensor's next scan may be long in coming.
struct Place {
    std::string frame;
    pelorus::Space space;

    template <class Archive> void state(Archive& archive) {
        std::vector<Line> lines;
        for (const pelorus::Component& each : space.components()) lines.push_back({each});
        archive(frame, lines);
        if constexpr (Archive::reading) {
            std::vector<pelorus::Component> components;
            for (Line& line : lines) components.push_back(std::move(line.component));
            space = pelorus::Space(std::move(components));
        }
    }

private:
    struct Line {
        pelorus::Component component;
        template <class Archive> void state(Archive& archive) {
            archive(component.name, component.unit, component.prior_mean, component.prior_deviation, component.angle);
        }
    };
};

inline Place place_of(const plr_scan& scan) { return {scan.frame, pelorus::Space(*scan.space)}; }

/// The only measurement of a scan that has one. Throws DataError for what cannot be put onto another time.
inline Sample sample_of(const plr_scan& scan, Clock time) {
    const std::string sensor = scan.sensor;
    if (scan.measurements.count != 1)
        throw pelorus::DataError("a scan of " + sensor + " has " + std::to_string(scan.measurements.count) +
                                 " measurements; those of one object, one a scan, can be put onto other times");
    if (scan.covariances.data == nullptr) throw pelorus::DataError("a scan of " + sensor + " carries no covariances");
    Sample sample;
    sample.time = scan.times == nullptr ? time : scan.times[0];
    sample.id = scan.ids[0];
    sample.value = pelorus::item(scan.measurements, 0);
    sample.covariance = pelorus::item(scan.covariances, 0);
    if (!sample.value.allFinite() || !sample.covariance.allFinite())
        throw pelorus::DataError("a scan of " + sensor + " has numbers that are not finite");
    return sample;
}

/// `value`, moved by whole turns so that its angles lie within half a turn of those of `reference`.
inline Eigen::VectorXd unwrapped(const pelorus::Space& space, const Eigen::VectorXd& reference, Eigen::VectorXd value) {
    const double turn = 2.0 * std::acos(-1.0);
    for (Eigen::Index c = 0; c < value.size(); ++c)
        if (space[static_cast<int>(c)].angle) value(c) -= turn * std::round((value(c) - reference(c)) / turn);
    return value;
}

/// Angles in (-pi, pi].
inline void wrap(const pelorus::Space& space, Eigen::VectorXd& value) {
    const double pi = std::acos(-1.0);
    for (Eigen::Index c = 0; c < value.size(); ++c) {
        if (!space[static_cast<int>(c)].angle) continue;
        value(c) = std::remainder(value(c), 2.0 * pi);
        if (value(c) <= -pi) value(c) = pi;
    }
}

/// What a stage makes of samples.
struct Estimate {
    Eigen::VectorXd value;
    Eigen::MatrixXd covariance;
    std::uint64_t id = 0;
};

}  // namespace streams
