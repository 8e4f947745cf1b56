/// Who is who among groups from step to step: ids that outlive splits and mergers, and parents that say what went in.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace track_then_group {

using Ids = std::vector<std::uint64_t>;

/// Groups are known by the tracks that are at home in them. A track's home is the group that it is in, or the one that it came
/// with when that was absorbed by another: so what merges and parts again is known again.
///
/// Each step, largest overlap of home and component first:
/// 1. a group goes on in the component that holds most of the tracks at home in it (ties: the older group);
/// 2. an absorbed group comes back as the component that holds more than half of its tracks and consists of them by half at least;
/// 3. what is left is a new group.
/// A group without a component is absorbed while tracks are at home in it, for `memory` at most; then it has ended.
class Lineage {
public:
    static constexpr std::int64_t always = std::numeric_limits<std::int64_t>::max();
    /// How long (ns) an absorbed group can come back.
    void setup(std::int64_t memory) { memory_ = memory; }

    /// Components are lists of tracks, each track in one of them. Answers the id of each component's group.
    Ids update(std::int64_t time, const std::vector<Ids>& components);

    /// Ids of all groups that members of this one came from, ascending; empty: it is nobody's child.
    Ids parents(std::uint64_t group) const;
    /// Groups that ended in the last update, ascending.
    const Ids& ended() const noexcept { return ended_; }

    template <class Archive> void state(Archive& archive) { archive(tracks_, groups_, next_id_, ended_); }

private:
    struct Track {
        std::uint64_t home = 0, group = 0;
        template <class Archive> void state(Archive& archive) { archive(home, group); }
    };
    struct Group {
        std::optional<std::int64_t> absorbed;  ///< ns; nothing: it is by itself
        std::set<std::uint64_t> parents;
        template <class Archive> void state(Archive& archive) { archive(absorbed, parents); }
    };
    void forget_missing(const std::vector<Ids>& components);
    void match(const std::vector<Ids>& components, bool absorbed, Ids& groups) const;
    void begin_groups(const std::vector<Ids>& components, Ids& groups);
    void note_parents(const std::vector<Ids>& components, const Ids& groups);
    void settle_homes(const std::vector<Ids>& components, const Ids& groups);
    void settle_groups(std::int64_t time, const Ids& groups);

    std::int64_t memory_ = always;
    std::map<std::uint64_t, Track> tracks_;
    std::map<std::uint64_t, Group> groups_;
    std::uint64_t next_id_ = 1;
    Ids ended_;
};

}  // namespace track_then_group
