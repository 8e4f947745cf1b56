/// When things happen: tick k of a period lies at round(k x period), in ns, never accumulated.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <pelorus/failure.hpp>

namespace simulation {

/// One clock. A period is held in ns as a double (0.05 s is 5e7 exactly), so that the product is exact up to 2^53.
class Clock {
public:
    /// How far a tick is off its place, in ns; always the same answer for the same tick.
    using Jitter = std::function<double(std::uint64_t tick)>;

    explicit Clock(double period_seconds, Jitter jitter = {})
        : period_(period_seconds * 1e9), jitter_(std::move(jitter)) {}
    std::int64_t time(std::uint64_t tick) const {
        constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();
        const long double exact = static_cast<long double>(tick) * static_cast<long double>(period_);
        if (!(exact < static_cast<long double>(never))) return never;
        const std::int64_t place = std::llround(exact);
        if (!jitter_) return place;
        const std::int64_t off = shift(tick);
        return off > never - place ? never : std::max<std::int64_t>(0, place + off);
    }

    /// In ns.
    double period() const noexcept { return period_; }

private:
    /// Ticks keep their order: each stays within half a period about its place.
    std::int64_t shift(std::uint64_t tick) const {
        const double most = std::max(0.0, period_ / 2 - 1);
        return std::llround(std::clamp(jitter_(tick), -most, most));
    }

    double period_;
    Jitter jitter_;
};

/// The events of some clocks up to and including `end`: the times (ns, ascending, each once) at which any of them ticks. Made as
/// they are asked for; a position among them is the next tick of each clock.
class Events {
public:
    using Position = std::vector<std::uint64_t>;

    Events() = default;
    /// Throws ParameterError for periods that clocks in ns cannot keep.
    Events(std::vector<Clock> clocks, std::int64_t end) : clocks_(std::move(clocks)), end_(end) {
        constexpr double most = 9007199254740992;  // 2^53
        for (const Clock& clock : clocks_) {
            if (!(clock.period() > 0) || !std::isfinite(clock.period()))
                throw pelorus::ParameterError("period", "is no period: it must be above 0 s");
            if (clock.period() < 1)
                throw pelorus::ParameterError("period", "is too short: times are counted in ns, so 1 ns is the least");
            if (!(static_cast<double>(end) / clock.period() < most))
                throw pelorus::ParameterError("period",
                                              "is too short for a run of this duration: more than 2^53 ticks");
        }
    }

    /// Time of the last event, or after it (ns).
    std::int64_t end() const noexcept { return end_; }
    Position first() const { return Position(clocks_.size(), 0); }
    bool is_due(std::size_t clock, const Position& at, std::int64_t time) const {
        return clocks_[clock].time(at[clock]) == time;
    }

    /// The times of the next `most` events from there on, fewer at the end.
    void times(Position at, std::size_t most, std::vector<std::int64_t>& times) const {
        times.clear();
        while (times.size() < most) {
            std::int64_t next = std::numeric_limits<std::int64_t>::max();
            for (std::size_t c = 0; c < clocks_.size(); ++c) next = std::min(next, clocks_[c].time(at[c]));
            if (next > end_) return;
            for (std::size_t c = 0; c < clocks_.size(); ++c) at[c] += is_due(c, at, next);
            times.push_back(next);
        }
    }

    /// The position so many events before. Throws DataError where there are not so many.
    Position before(Position at, std::uint64_t events) const {
        for (; events > 0; --events) {
            std::int64_t last = -1;
            for (std::size_t c = 0; c < clocks_.size(); ++c)
                if (at[c] > 0) last = std::max(last, clocks_[c].time(at[c] - 1));
            if (last < 0) throw pelorus::DataError("saved state is of another simulation");
            for (std::size_t c = 0; c < clocks_.size(); ++c) at[c] -= at[c] > 0 && clocks_[c].time(at[c] - 1) == last;
        }
        return at;
    }

private:
    std::vector<Clock> clocks_;
    std::int64_t end_ = 0;
};

}  // namespace simulation
