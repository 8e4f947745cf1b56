/// Where a sensor looks: a field of view about a direction that commands can turn.
///
/// Directions are azimuth and elevation along the sensor's own axes, in rad, as it measures them itself: so the view needs to know
/// nothing of mounts, and a mount that stands wrongly looks wrongly.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <pelorus/messages.hpp>
#include <pelorus/sensor.hpp>

#include "sensor_values.hpp"

namespace simulation {

/// A direction: azimuth from +x to +y, elevation from the x-y plane up (rad).
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

class SensorView {
public:
    /// A view of everything.
    SensorView() = default;
    /// Throws PartError for what measures no azimuth.
    SensorView(const SensorValues& values, const pelorus::Space& measurement, const std::string& sensor)
        : sensor_(sensor), slew_rate_(values.slew_rate.value_or(std::numeric_limits<double>::infinity())) {
        if (!values.field_of_view) {
            if (values.pointing || values.slew_rate)
                refuse("can be pointed, but sees everything: give it a field_of_view");
            return;
        }
        field_ = *values.field_of_view;
        azimuth_ = measurement.index("azimuth");
        elevation_ = measurement.index("elevation");
        zenith_ = measurement.index("zenith");
        if (azimuth_ < 0) refuse("has a field_of_view, but measures no azimuth: " + measurement.text());
        if (in_plane() && field_.size() != 1)
            refuse("measures azimuth alone, and so does its field_of_view have one angle");
        if (!values.pointing) return;
        if (const std::string fault = fault_of(*values.pointing); !fault.empty())
            refuse("has a pointing that " + fault);
        at_ = direction(*values.pointing);
    }

    bool is_limited() const noexcept { return azimuth_ >= 0; }
    /// Whether the view is that of this time.
    bool was_moved(std::int64_t time) const noexcept { return now_ == time; }
    /// One angle, or two.
    std::vector<double> pointing() const {
        return in_plane() ? std::vector<double>{at_.azimuth} : std::vector<double>{at_.azimuth, at_.elevation};
    }

    /// Takes a command `pointing`: in force from valid_from on, until another one or its end; then the view rests where it is.
    void take(const plr_quantity& quantity) {
        if (!is_limited())
            throw pelorus::DataError("sensor " + sensor_ + " has no field of view that could be pointed");
        if (std::string(quantity.unit) != "rad")
            throw pelorus::DataError("the pointing of sensor " + sensor_ + " is in rad, the command in " +
                                     quantity.unit);
        const plr_const_view& v = quantity.numbers;
        std::vector<double> angles;
        for (std::int64_t r = 0; r < v.rows * v.cols; ++r)
            angles.push_back(pelorus::item(v, 0)(r % v.rows, r / v.rows));
        if (const std::string fault = fault_of(angles); !fault.empty())
            throw pelorus::DataError("the command to point sensor " + sensor_ + " " + fault);
        const Command command{direction(angles), quantity.valid_from, quantity.valid_to};
        while (!commands_.empty() && commands_.back().from >= command.from) commands_.pop_back();
        commands_.push_back(command);
    }

    /// Turns to where it looks at `time` (ns), at the slew rate and along great circles.
    void move(std::int64_t time) {
        for (std::size_t k = 0; k < commands_.size() && commands_[k].from < time; ++k) {
            const Command& command = commands_[k];
            const std::int64_t begin = std::max(now_, command.from);
            const std::int64_t next = k + 1 < commands_.size() ? commands_[k + 1].from : time;
            const std::int64_t end = std::min({time, next, command.to});
            if (end > begin)
                at_ = turned(at_, command.direction, slew_rate_ * (static_cast<double>(end - begin) * 1e-9));
        }
        now_ = std::max(now_, time);
        while (commands_.size() > 1 && commands_[1].from <= now_) commands_.erase(commands_.begin());
    }

    /// Whether what gives this measurement, without its noise, lies in the field.
    bool sees(const double* measurement) const {
        if (!is_limited()) return true;
        Direction seen{measurement[azimuth_], 0};
        if (in_plane()) return std::fabs(pelorus::wrap_angle(seen.azimuth - at_.azimuth)) <= field_[0] / 2;
        seen.elevation = elevation_ >= 0 ? measurement[elevation_] : std::acos(0.0) - measurement[zenith_];
        const pelorus::Vector<3> way = seen.unit();
        if (field_.size() == 1) return std::atan2(way.cross(at_.unit()).norm(), way.dot(at_.unit())) <= field_[0] / 2;
        // Along the view's own axes: forward, to the left, up.
        const double c = std::cos(at_.azimuth), s = std::sin(at_.azimuth), level = c * way(0) + s * way(1),
                     forward = std::cos(at_.elevation) * level + std::sin(at_.elevation) * way(2),
                     left = c * way(1) - s * way(0),
                     up = std::cos(at_.elevation) * way(2) - std::sin(at_.elevation) * level;
        return std::fabs(std::atan2(left, forward)) <= field_[0] / 2 &&
               std::fabs(std::atan2(up, forward)) <= field_[1] / 2;
    }

    template <class Archive> void state(Archive& archive) { archive(at_, now_, commands_); }

private:
    struct Command {
        Direction direction;
        std::int64_t from = 0, to = 0;  // ns
        template <class Archive> void state(Archive& archive) { archive(direction, from, to); }
    };

    bool in_plane() const noexcept { return elevation_ < 0 && zenith_ < 0; }
    [[noreturn]] void refuse(const std::string& why) const {
        throw pelorus::PartError("sensors", "sensor " + sensor_ + " " + why);
    }
    /// Why these angles are no direction, or "".
    std::string fault_of(const std::vector<double>& angles) const {
        if (angles.size() != (in_plane() ? 1u : 2u))
            return "has " + std::to_string(angles.size()) + " angles, not " +
                   (in_plane() ? "1 (azimuth)" : "2 (azimuth, elevation)");
        if (!std::isfinite(angles[0]) || !(std::fabs(angles.back()) <= (in_plane() ? 1e9 : std::acos(0.0))))
            return "is no direction: an elevation lies within -pi/2 and pi/2";
        return "";
    }
    Direction direction(const std::vector<double>& angles) const {
        return {pelorus::wrap_angle(angles[0]), in_plane() ? 0.0 : angles[1]};
    }

    std::string sensor_;
    double slew_rate_ = 0;       ///< rad/s
    std::vector<double> field_;  ///< rad, full angles
    int azimuth_ = -1, elevation_ = -1, zenith_ = -1;

    // What save keeps.
    Direction at_;
    std::int64_t now_ = -1;  ///< ns
    std::vector<Command> commands_;
};

}  // namespace simulation
