/// Stamps that run ahead: one that is wrong must not close all times until then.
#pragma once

#include <cstdlib>
#include <optional>

#include "sample.hpp"

namespace streams {

/// Throws DataError for a stamp that no clock tells, so that sums of times stay within 64 bits.
inline void check_stamp(const std::string& sensor, Clock time) {
    constexpr Clock century = 4'000'000'000'000'000'000;  // ns: 127 years
    if (time < -century || time > century)
        throw pelorus::DataError("a scan of " + sensor + " has a stamp out of range");
}

/// How far ahead of their arrivals stamps have been. A stamp that leaps ahead of that is left out; where the next
/// one agrees with it, the clock has been set.
class Leaps {
public:
    bool is_leap(Clock stamp, Clock arrival, Clock tolerance) const {
        const Clock ahead = stamp - arrival;
        return ahead_ && ahead - *ahead_ > tolerance && !(leapt_ && std::llabs(ahead - *leapt_) <= tolerance);
    }
    void note(Clock stamp, Clock arrival, bool is_leap) {
        const Clock ahead = stamp - arrival;
        if (is_leap) {
            leapt_ = ahead;
        } else {
            ahead_ = std::max(ahead_.value_or(ahead), ahead);
            leapt_.reset();
        }
    }
    template <class Archive> void state(Archive& archive) { archive(ahead_, leapt_); }

private:
    std::optional<Clock> ahead_, leapt_;  ///< ns
};

}  // namespace streams
