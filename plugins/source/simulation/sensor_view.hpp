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

#include <pelorus/messages.hpp>
#include <pelorus/sensor.hpp>

#include "../../common/sensing/direction.hpp"
#include "sensor_values.hpp"

namespace simulation {

using sensing::Direction;

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
                at_ = sensing::turned(at_, command.direction, slew_rate_ * (static_cast<double>(end - begin) * 1e-9));
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
        if (field_.size() == 1) return sensing::angle_between(seen, at_) <= field_[0] / 2;
        const sensing::Offset off = sensing::offset_in_view(at_, seen);
        return std::fabs(off.left) <= field_[0] / 2 && std::fabs(off.up) <= field_[1] / 2;
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
