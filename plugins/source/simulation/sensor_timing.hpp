/// When a sensor measures, what its clock says then, and when its scan arrives.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include <pelorus/failure.hpp>

#include "draws.hpp"
#include "sensor_values.hpp"
#include "ticks.hpp"

namespace simulation {

/// All times in ns. Immutable.
class SensorTiming {
public:
    static constexpr std::uint64_t stream_jitter = 1001, stream_delay = 1002;

    SensorTiming() = default;
    /// Throws PartError for outages that do not end.
    SensorTiming(const SensorValues& values, const std::string& sensor) : values_(values), number_(number_of(sensor)) {
        if (!values_.outage) return;
        const std::vector<double>& outage = *values_.outage;
        if (outage.size() % 2 != 0)
            throw pelorus::PartError(
                "sensors", "outage of sensor " + sensor + " is in pairs of from and to; the last " + "one has no end");
        for (std::size_t k = 0; k < outage.size(); k += 2)
            if (!(outage[k] < outage[k + 1]))
                throw pelorus::PartError("sensors", "outage of sensor " + sensor + " ends before it begins");
    }

    /// Its ticks, `period` (s) being the simulation's.
    Clock clock(const Draws& draws, double period) const {
        const double own = values_.period.value_or(period);
        if (values_.jitter == 0) return Clock(own);
        return Clock(own, [draws, number = number_, deviation = values_.jitter * 1e9](std::uint64_t tick) {
            return deviation * draws.normals(stream_jitter, {number, 0, tick, 0}, 0, 1).front();
        });
    }

    bool is_out(std::int64_t time) const noexcept {
        if (!values_.outage) return false;
        const double now = static_cast<double>(time) * 1e-9;
        for (std::size_t k = 0; k < values_.outage->size(); k += 2)
            if (now >= (*values_.outage)[k] && now < (*values_.outage)[k + 1]) return true;
        return false;
    }

    /// What its clock says at `time`.
    std::int64_t stamp(std::int64_t time) const noexcept { return time + std::llround(values_.clock_offset * 1e9); }

    /// When the scan that it measured at `time`, its tick `tick`, is there.
    std::int64_t arrival(const Draws& draws, std::uint64_t tick, std::int64_t time) const {
        double delay = values_.delay;
        if (values_.delay_spread > 0)
            delay += values_.delay_spread * draws.uniform(stream_delay, {number_, 0, tick, 0}, 0);
        return time + std::llround(delay * 1e9);
    }

private:
    SensorValues values_;
    std::uint64_t number_ = 0;
};

}  // namespace simulation
