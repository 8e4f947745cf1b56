/// How far a sensor has got with its target: the states, and the rules by which looks move from one to the other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "search_pattern.hpp"

namespace pointing_scheduler {

/// `searching`: where the target may be does not fit into the field; `acquiring`: it does, but it was not seen often enough yet.
enum class State { idle, searching, acquiring, locked, lost };

/// Counts of looks, in a row.
struct Rules {
    std::int64_t lock_looks = 3;   ///< that see the target: locked
    std::int64_t loss_looks = 5;   ///< that do not: lost; and how long a place that is all there is is looked at
    std::int64_t dwell_looks = 1;  ///< at each of several places
};

struct Lock {
    State now = State::idle;
    std::int64_t hits = 0, misses = 0;  ///< looks in a row
    Place place;                        ///< where it looks next
    std::int64_t places = 1;            ///< of the pattern that this is one of
    std::int64_t looks_there = 0;       ///< that saw nothing
    std::vector<Place> done;            ///< places that saw nothing
    std::int64_t passes = 0;            ///< whole patterns that saw nothing

    /// A new target.
    void begin() {
        *this = Lock{};
        now = State::acquiring;
    }

    /// After a look; `there`: the sensor did look where it was told.
    void look(const Rules& rules, bool hit, bool there) {
        if (hit) {
            ++hits;
            misses = passes = 0;
            begin_pattern();
            if (hits >= rules.lock_looks) now = State::locked;
            return;
        }
        hits = 0;
        ++misses;
        if (now == State::locked) {
            if (misses < rules.loss_looks) return;
            now = State::lost;
            passes = 1;  // where it is predicted to be it was not
            begin_pattern();
        } else if (there && ++looks_there >= (places > 1 ? rules.dwell_looks : rules.loss_looks)) {
            looks_there = 0;
            done.push_back(place);
        }
    }

    /// The prediction, which places are counted from, has moved by so much: what was looked at lies elsewhere in its view.
    void shift(const sensing::Offset& by) {
        for (Place& each : done) {
            each.at.left -= by.left;
            each.at.up -= by.up;
        }
    }

    /// Chooses the likeliest place, of those ordered so, that was not looked at; false: there is none, and the pattern begins again.
    /// `pitch`: from a field to its neighbours; what is nearer than half of that was looked at.
    bool choose(const std::vector<Place>& pattern, const sensing::Offset& pitch) {
        for (const Place& each : pattern) {
            const auto is_near = [&](const Place& other) {
                return std::fabs(other.at.left - each.at.left) <= pitch.left / 2 &&
                       std::fabs(other.at.up - each.at.up) <= pitch.up / 2;
            };
            if (std::any_of(done.begin(), done.end(), is_near)) continue;
            if (!place.same(each)) looks_there = 0;
            place = each;
            places = static_cast<std::int64_t>(pattern.size());
            if (now == State::searching || now == State::acquiring)
                now = places > 1 ? State::searching : State::acquiring;
            return true;
        }
        begin_pattern();
        ++passes;
        return false;
    }

    template <class Archive> void state(Archive& archive) {
        archive(now, hits, misses, place, places, looks_there, done, passes);
    }

private:
    void begin_pattern() {
        done.clear();
        looks_there = 0;
    }
};

}  // namespace pointing_scheduler
