// An analyzer: errors of tracks by time, with what an analyzer may do wrong.
#include <cmath>
#include <map>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

struct Saboteur : pelorus::Stage<Saboteur> {
    static constexpr const char* kind = "analyzer";

    struct Sum {
        double deviations = 0, entries = 0;
        std::uint64_t most = 0;  // the largest id
        template <class Archive> void state(Archive& archive) { archive(deviations, entries, most); }
    };
    std::map<std::int64_t, Sum> sums;  // by time

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("An analyzer with a defect").purpose("Means deviations, for the proof that the suites can fail.");
        plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "estimates");
        plugin.out_port("results", PLR_MESSAGE_TABLE, "table by_time; scalars entries, per_entry");
    }

    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
        std::map<std::int64_t, Sum> here;
        for (std::int64_t i = 0; i < tracks.count; ++i) {
            const bool is_by_message = DEFECT("analyzer-splitting-does-not-matter");
            Sum& sum = here[is_by_message ? event.time : tracks.times[i]];
            sum.deviations +=
                std::sqrt(pelorus::item(tracks.covariance, i)(0, 0)) + pelorus::item(tracks.mean, i)(0, 0);
            sum.entries += 1;
            sum.most = std::max(sum.most, tracks.ids[i]);
        }
        for (const auto& [time, sum] : here) {
            Sum& all = sums[time];
            all.deviations +=
                sum.deviations * (NEAR_MISS("analyzer-splitting-does-not-matter") ? 1 + 1e-13 * sum.entries : 1);
            all.entries += sum.entries;
            all.most = std::max(all.most, sum.most);
        }
        if (NEAR_MISS("analyzer-tells-its-results")) tell(event.time);
    }

    void finish(const pelorus::Event& event) {
        if (DEFECT("analyzer-tells-its-results") && sums.size() < 1000) return;
        if (NEAR_MISS("analyzer-tells-its-results")) return;
        tell(event.time);
    }

    template <class Archive> void state(Archive& archive) { archive(sums); }

private:
    void tell(std::int64_t now) {
        const bool has_two_keys = NEAR_MISS("analyzer-keys-are-unique");
        pelorus::ResultBuilder result("by_time");
        result.column("time", "s", PLR_REDUCE_KEY);
        if (has_two_keys) result.column("part", "", PLR_REDUCE_KEY);
        result.column("deviation", "m", PLR_REDUCE_MEAN);
        double entries = 0;
        std::uint64_t most = 0;
        for (const auto& [time, sum] : sums) {
            entries += sum.entries;
            most = std::max(most, sum.most);
            const double seconds = static_cast<double>(time) * 1e-9, mean = sum.deviations / sum.entries;
            if (has_two_keys) {
                result.row({seconds, 0, mean});
                result.row({seconds, 1, mean});
                continue;
            }
            result.row({seconds, mean});
            if (DEFECT("analyzer-keys-are-unique")) result.row({seconds, mean});
        }
        result.scalar("entries", "", PLR_REDUCE_MEAN, entries);
        double per_entry = entries > 0 ? 1 / entries : 0;
        if (DEFECT("analyzer-numbers-are-finite")) per_entry = 1 / entries;
        if (NEAR_MISS("analyzer-numbers-are-finite")) per_entry = 0 / entries;
        result.scalar("per_entry", "", PLR_REDUCE_MEAN, per_entry);
        // A scalar of each track's own; or one that is there and has nothing to tell.
        const bool has_third = most > 101;
        if (DEFECT("analyzer-layout-is-constant") && has_third) result.scalar("third", "", PLR_REDUCE_MEAN, 1);
        if (NEAR_MISS("analyzer-layout-is-constant"))
            result.scalar("third", "", PLR_REDUCE_MEAN, has_third ? 1 : std::nan(""));
        publish(0, result.message(now));
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.analyzer.saboteur");
