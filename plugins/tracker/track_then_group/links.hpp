/// Which pairs of tracks belong together: near each other and, if asked for, of one velocity, with hysteresis in both and in time.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace track_then_group {

/// What is linked: a track at the time of the step. Axes that it does not have are 0.
struct Member {
    std::uint64_t id = 0;
    std::array<double, 3> position{}, velocity{};  ///< m, m/s
};

struct LinkRule {
    double threshold = 0;                      ///< d0, m
    double hysteresis = 0;                     ///< share of the thresholds; 0: none
    std::optional<double> velocity_threshold;  ///< v0, m/s
    std::int64_t persistence = 0;              ///< ns
};

/// Indices of two members, the first less than the second.
using IndexPair = std::pair<std::size_t, std::size_t>;

/// All pairs less than `distance` (1e-9 m to 1e15 m) apart, ascending: exact whatever the range of the numbers, by the grid of the
/// partition by distance.
std::vector<IndexPair> near_pairs(const std::vector<Member>& members, double distance);

/// The pairs that are linked now, and what is remembered of the others: a pair links when it is nearer than (1 - h) of the
/// thresholds and unlinks when it is not nearer than (1 + h) of one of them, either after the state has lasted `persistence`.
class Links {
public:
    void setup(const LinkRule& rule) { rule_ = rule; }
    /// Linked pairs at `time` (ns), ascending; members ascend by id. Whoever is not among them loses its links.
    std::vector<IndexPair> update(std::int64_t time, const std::vector<Member>& members);

    template <class Archive> void state(Archive& archive) { archive(pairs_); }

private:
    using Ids = std::pair<std::uint64_t, std::uint64_t>;
    struct Pair {
        bool linked = false;
        bool turning = false;    ///< the contrary of `linked` has held since then
        std::int64_t since = 0;  ///< ns
        template <class Archive> void state(Archive& archive) { archive(linked, turning, since); }
    };
    /// The pair is nearer than `scale` times the thresholds, in space and in velocity.
    bool is_within(const Member& a, const Member& b, double scale) const;
    bool has_turned(Pair& pair, std::int64_t time) const;

    LinkRule rule_;
    std::map<Ids, Pair> pairs_;
};

/// Connected components of `size` members; each ascends, and they are in the order of their first members.
std::vector<std::vector<std::size_t>> components(std::size_t size, const std::vector<IndexPair>& pairs);

}  // namespace track_then_group
