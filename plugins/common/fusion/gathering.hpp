/// Scans of one time from several sensors: who has come, for whom to wait, and how long.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <pelorus/describe.hpp>

#include "pieces.hpp"

namespace fusion {

/// What is done with what only some of the sensors tell.
enum class Alone { pass, drop };

/// One measurement or track, as far as fusion is concerned.
struct Sighting {
    std::uint64_t id = 0;
    Eigen::VectorXd value;
    Eigen::MatrixXd covariance;
    std::int32_t status = 0;  ///< of a track
    template <class Archive> void state(Archive& archive) { archive(id, value, covariance, status); }
};

/// What one sensor saw.
struct Sight {
    int sensor = 0;
    std::int64_t time = 0;  ///< ns
    std::vector<Sighting> sightings;
    template <class Archive> void state(Archive& archive) { archive(sensor, time, sightings); }
};

/// What the sensors saw at one time.
struct Meeting {
    std::int64_t time = 0;      ///< ns: the stamp of the first of the sensors, in the order of the file
    std::int64_t arrival = 0;   ///< ns: when the first came
    std::vector<Sight> sights;  ///< in the order of sensors
    template <class Archive> void state(Archive& archive) { archive(time, arrival, sights); }
};

/// Parameters of a gathering; a base of the plugins.
struct GatheringParameters {
    double tolerance = 0, patience = 0;  // s
    Alone alone = Alone::pass;

    template <class Plugin> static void describe_gathering(pelorus::Describe<Plugin>& plugin) {
        plugin.parameter("tolerance", &GatheringParameters::tolerance)
            .unit("s")
            .initially("0 s")
            .min(0)
            .max(1e6)
            .doc("stamps that differ by this much at most are of one time");
        plugin.parameter("patience", &GatheringParameters::patience)
            .unit("s")
            .initially("0 s")
            .min(0)
            .max(1e6)
            .doc("how long the first waits for the others, by arrivals; 0: for what arrives together with it");
        plugin.parameter("alone", &GatheringParameters::alone)
            .initially("pass")
            .choices({{"pass", "what some sensors tell is published where it determines all components"},
                      {"drop", "only what all sensors tell is published"}})
            .doc("what becomes of a time, or of a measurement, that not all sensors have told of");
    }
};

/// Collects and gives back in the order of times. What it holds is bounded.
class Gathering {
public:
    static constexpr std::size_t most_held = 64;  ///< times; beyond, the oldest is not waited for any longer

    void setup(const GatheringParameters& parameters, int sensors) {
        tolerance_ = std::llround(parameters.tolerance * 1e9);
        patience_ = std::llround(parameters.patience * 1e9);
        sensors_ = static_cast<std::size_t>(sensors);
    }

    /// Whether a scan of this time can still be used: nothing of it or of a later time has been given back.
    bool is_late(std::int64_t time) const noexcept { return last_ && time <= *last_; }
    /// Whether that sensor has told of this time already.
    bool has(int sensor, std::int64_t time) const {
        return std::any_of(held_.begin(), held_.end(), [&](const Meeting& meeting) {
            return std::any_of(meeting.sights.begin(), meeting.sights.end(),
                               [&](const Sight& sight) { return sight.sensor == sensor && sight.time == time; });
        });
    }
    /// Not late, and not told before.
    void add(std::int64_t arrival, Sight sight) {
        Meeting* meeting = nearest(sight);
        if (meeting == nullptr) meeting = &held_.emplace_back(Meeting{sight.time, arrival, {}});
        const auto place = std::upper_bound(meeting->sights.begin(), meeting->sights.end(), sight.sensor,
                                            [](int s, const Sight& other) { return s < other.sensor; });
        if (place == meeting->sights.begin()) meeting->time = sight.time;
        meeting->sights.insert(place, std::move(sight));
        std::stable_sort(held_.begin(), held_.end(),
                         [](const Meeting& a, const Meeting& b) { return a.time < b.time; });
    }
    /// The oldest time, if it need not be waited for at this arrival; to be asked until there is none.
    std::optional<Meeting> next(std::int64_t arrival) {
        if (held_.empty()) return std::nullopt;
        const Meeting& oldest = held_.front();
        const bool is_due = oldest.sights.size() == sensors_ || arrival > oldest.arrival + patience_;
        return is_due || held_.size() > most_held ? std::optional(pop()) : std::nullopt;
    }
    /// The oldest time, waited for or not.
    std::optional<Meeting> last() { return held_.empty() ? std::nullopt : std::optional(pop()); }

    template <class Archive> void state(Archive& archive) { archive(held_, last_); }

private:
    /// The nearest time within the tolerance of which this sensor has not told, or nullptr.
    Meeting* nearest(const Sight& sight) {
        Meeting* best = nullptr;
        for (Meeting& meeting : held_) {
            const std::int64_t off = std::abs(meeting.time - sight.time);
            const bool is_taken = std::any_of(meeting.sights.begin(), meeting.sights.end(),
                                              [&](const Sight& other) { return other.sensor == sight.sensor; });
            if (off > tolerance_ || is_taken) continue;
            if (best == nullptr || off < std::abs(best->time - sight.time)) best = &meeting;
        }
        return best;
    }
    Meeting pop() {
        Meeting oldest = std::move(held_.front());
        held_.pop_front();
        last_ = last_ ? std::max(*last_, oldest.time) : oldest.time;
        return oldest;
    }

    std::deque<Meeting> held_;
    std::optional<std::int64_t> last_;  ///< ns
    std::int64_t tolerance_ = 0, patience_ = 0;
    std::size_t sensors_ = 0;
};

}  // namespace fusion
