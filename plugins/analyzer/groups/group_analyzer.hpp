/// analyzer.groups: how many groups there are, and who came from whom. See README.md.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <pelorus/stage.hpp>

namespace analyzer_groups {

class GroupAnalyzer : public pelorus::Stage<GroupAnalyzer> {
public:
    static constexpr const char* kind = "analyzer";
    enum Port : std::uint32_t { tracks, truth, groups };

    static void describe(pelorus::Describe<GroupAnalyzer>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;

    void on_tracks(const pelorus::Event& event, const plr_tracks& message);
    void on_truth(const pelorus::Event& event, const plr_truth& message);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        archive(live_, counts_, places_, told_lives_, group_lives_, track_lives_, named_);
    }

private:
    /// What there was after the tracks of one time.
    struct Count {
        std::uint64_t tracks = 0, groups = 0, unnamed = 0;  ///< confirmed tracks, groups of them, tracks without one
        template <class Archive> void state(Archive& archive) { archive(tracks, groups, unnamed); }
    };
    struct Place {
        double x = 0, y = 0, z = 0;  // m
        template <class Archive> void state(Archive& archive) { archive(x, y, z); }
    };
    /// When a group was there, and where it came from.
    struct Life {
        std::int64_t start = 0, end = 0;  // ns
        std::uint64_t most_tracks = 1;
        std::set<std::uint64_t> parents;
        template <class Archive> void state(Archive& archive) { archive(start, end, most_tracks, parents); }
    };
    using Lives = std::map<std::uint64_t, Life>;

    /// One time of the table.
    struct Row {
        double time = 0, groups = 0, tracks = 0, true_groups = 0, objects = 0;
    };

    void take(const plr_tracks& message, std::int64_t i);
    static void note(Lives& lives, const plr_tracks& message, std::int64_t i);
    static Life& live(Lives& lives, std::uint64_t id, std::int64_t time);
    void count(std::int64_t time);
    std::vector<Row> rows() const;
    void publish_counts(const std::vector<Row>& rows, std::int64_t time);
    void publish_lineage(std::int64_t time);
    double variation(const std::vector<Row>& rows, double Row::*column) const;

    std::optional<double> threshold_;  // m
    double variation_from_ = 0;        // s
    std::vector<double> counts_at_;    // s
    std::string frame_;

    std::map<std::uint64_t, std::uint64_t> live_;  ///< confirmed tracks now, with their groups (0: none)
    std::map<std::int64_t, Count> counts_;         ///< by time (ns)
    std::map<std::int64_t, std::map<std::uint64_t, Place>> places_;  ///< objects, by time (ns)
    Lives told_lives_, group_lives_, track_lives_;  ///< told at the port groups; named by tracks; tracks themselves
    bool named_ = false;                            ///< tracks have named their groups
};

}  // namespace analyzer_groups
