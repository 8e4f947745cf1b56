/// Who followed whom: the bookkeeping of analyzer.identity.
///
/// A report is a measurement that the truth says came from an identity. A track uses measurements. Reports are judged in
/// the order in which they came, once no track can take them any more.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

namespace analyzer_identity {

/// How often each one was met, and which most often (the smallest number among equals).
class Shares {
public:
    void add(std::uint64_t who) { ++counts_[who]; }
    std::uint64_t count(std::uint64_t who) const;
    std::uint64_t total() const;
    std::optional<std::uint64_t> main() const;
    std::size_t size() const noexcept { return counts_.size(); }
    template <class Archive> void state(Archive& archive) { archive(counts_); }

private:
    std::map<std::uint64_t, std::uint64_t> counts_;
};

/// One identity.
struct Followed {
    std::uint64_t reports = 0;    ///< judged so far
    std::uint64_t tracked = 0;    ///< of them used by a track
    std::uint64_t switches = 0;   ///< tracked reports whose track is not that of the tracked report before
    std::uint64_t fragments = 0;  ///< times that tracking went on after it had broken off
    Shares tracks;                ///< which used its reports
    std::int64_t first = 0;       ///< ns, its first report
    std::optional<std::int64_t> first_tracked;  ///< ns, the first that was tracked
    std::optional<std::uint64_t> last_track;
    bool broken_off = false;
    template <class Archive> void state(Archive& archive) {
        archive(reports, tracked, switches, fragments, tracks, first, first_tracked, last_track, broken_off);
    }
};

/// One track.
struct Follower {
    std::uint64_t measurements = 0;  ///< used
    std::uint64_t unknown = 0;       ///< of them from nobody known: false alarms
    Shares identities;
    std::int64_t start = 0, end = 0;  ///< ns, of its entries
    template <class Archive> void state(Archive& archive) { archive(measurements, unknown, identities, start, end); }
};

/// The share of a track's measurements that came from its main identity.
double purity(const Follower& track);

class Tally {
public:
    void report(std::uint64_t identity, std::uint64_t measurement, std::int64_t time);
    void entry(std::uint64_t track, std::int64_t time);
    void use(std::uint64_t track, std::uint64_t measurement);
    /// Judges all reports that came before `time`.
    void judge(std::int64_t time);
    void judge_all();

    const std::map<std::uint64_t, Followed>& identities() const noexcept { return identities_; }
    const std::map<std::uint64_t, Follower>& tracks() const noexcept { return tracks_; }

    template <class Archive> void state(Archive& archive) { archive(identities_, tracks_, open_, queue_); }

private:
    struct Report {
        std::uint64_t identity = 0;
        std::optional<std::uint64_t> track;
        template <class Archive> void state(Archive& archive) { archive(identity, track); }
    };
    void judge_first();

    std::map<std::uint64_t, Followed> identities_;
    std::map<std::uint64_t, Follower> tracks_;
    std::map<std::uint64_t, Report> open_;                      // by measurement
    std::deque<std::pair<std::int64_t, std::uint64_t>> queue_;  // time and measurement, as they came
};

}  // namespace analyzer_identity
