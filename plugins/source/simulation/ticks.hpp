/// When things happen: tick k of a period lies at round(k x period), in ns, never accumulated.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <pelorus/failure.hpp>

namespace simulation {

/// One clock. A period is held in ns as a double (0.05 s is 5e7 exactly), so that the product is exact up to 2^53.
class Clock {
public:
    explicit Clock(double period_seconds) : period_(period_seconds * 1e9) {}
    std::int64_t time(std::uint64_t tick) const noexcept {
        return std::llround(static_cast<long double>(tick) * static_cast<long double>(period_));
    }

    /// How many ticks have times 0 .. end, within one; not finite or negative where the period is none.
    double ticks_until(std::int64_t end) const noexcept {
        return std::isfinite(period_) ? std::floor((static_cast<double>(end) + 0.5) / period_) + 1 : period_;
    }

private:
    double period_;
};

/// The times (ns, ascending, each once) of all ticks up to and including `end`. Throws ParameterError where there are too many to keep.
inline std::vector<std::int64_t> all_ticks(const std::vector<Clock>& clocks, std::int64_t end) {
    constexpr int most = 100'000'000;
    double expected = 0;
    for (const Clock& clock : clocks) {
        if (!(clock.ticks_until(end) >= 0))
            throw pelorus::ParameterError("period", "is no period: it must be above 0 s");
        expected += clock.ticks_until(end);
    }
    if (!(expected <= most))
        throw pelorus::ParameterError(
            "period", "is too short for a run of this duration: more than " + std::to_string(most) + " ticks");
    std::vector<std::int64_t> times;
    for (const Clock& clock : clocks)
        for (std::uint64_t k = 0; clock.time(k) <= end; ++k) times.push_back(clock.time(k));
    std::sort(times.begin(), times.end());
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

}  // namespace simulation
