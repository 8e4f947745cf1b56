/// A sensor that is said to stand along the new axes: whether it does.
#pragma once

#include <pelorus/caller.hpp>
#include <pelorus/space.hpp>

#include "placement.hpp"

namespace rigid {

class LocalSensor {
public:
    LocalSensor() = default;
    explicit LocalSensor(const pelorus::SensorPart& sensor) : sensor_(sensor), space_(*sensor.info().measurement) {}

    const pelorus::Space& space() const noexcept { return space_; }
    std::uint64_t scratch_bytes() const { return sensor_.info().scratch_bytes; }

    /// Whether it measures points as from the new origin along the new axes, if it is asked for them among the axes that `motion`
    /// leads from: so its mount there is the new axes; with the identity, it has none. Sensors that measure anything but coordinates,
    /// range and angles of a position are taken at their word.
    bool stands_there(const Motion& motion, std::int64_t time, pelorus::Caller& caller) const;

private:
    pelorus::SensorPart sensor_;
    pelorus::Space space_;
};

}  // namespace rigid
