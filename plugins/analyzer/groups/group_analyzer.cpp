#include "group_analyzer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "../../common/partition/group_count.hpp"

namespace analyzer_groups {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

double real(std::uint64_t count) { return static_cast<double>(count); }
double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

bool is_live(std::int32_t status) { return status == PLR_TRACK_CONFIRMED || status == PLR_TRACK_COASTING; }

/// A time (s) as part of a name: 50, 0_5.
std::string name_of(double time) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", time);
    std::string name = text;
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

}  // namespace

void GroupAnalyzer::describe(pelorus::Describe<GroupAnalyzer>& plugin) {
    plugin.title("Groups")
        .purpose(
            "How many groups a tracker sees over time, beside how many there are; how steady their number is; and "
            "which "
            "group came from which. Groups are those that tracks name, or the tracks themselves where they name none.")
        .equation(
            "true groups: connected components of the objects' positions, linked where |a - b| < threshold; total "
            "variation = sum over the times from variation_from on of |N(k) - N(k - 1)|")
        .source(
            "L. Han, L. Zhou, Research on group partitioning algorithm of space dense targets, Journal of Ordnance "
            "Equipment Engineering 41(12), 240-246, 2020 (number of groups over time)");
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "tracks with the ids of their groups, or groups as tracks");
    plugin.in_port("truth", PLR_MESSAGE_TRUTH, "what really is", PLR_PORT_OPTIONAL);
    plugin.in_port("groups", PLR_MESSAGE_TRACKS, "the groups that the tracks name, with their parents",
                   PLR_PORT_OPTIONAL);
    plugin.out_port("results", PLR_MESSAGE_TABLE, "tables by_time and lineage and their scalars, at the end");
    plugin.parameter("threshold", &GroupAnalyzer::threshold_)
        .unit("m")
        .min(1e-9)
        .max(1e15)
        .doc("objects less than so far apart are in one group; absent: true groups are not told");
    plugin.parameter("variation_from", &GroupAnalyzer::variation_from_)
        .unit("s")
        .initially("0 s")
        .doc("time of the first step that counts in total_variation");
    plugin.parameter("counts_at", &GroupAnalyzer::counts_at_)
        .unit("s")
        .initially("[]")
        .rows(0, 100)
        .doc("times whose numbers of groups become scalars: count_at_50 for 50 s");
}

void GroupAnalyzer::setup(const pelorus::Setup& setup) {
    frame_ = setup.frame();
    std::set<std::string> names;
    for (const double at : counts_at_)
        if (!names.insert(name_of(at)).second)
            throw pelorus::ParameterError("counts_at", "two values give one scalar, count_at_" + name_of(at));
}

std::vector<pelorus::Stream> GroupAnalyzer::in_streams(std::uint32_t) const {
    pelorus::Stream stream;
    stream.any_sensor = true;
    stream.space = pelorus::position_space(1);
    stream.frame = frame_;
    stream.at_least = true;
    return {stream};
}

void GroupAnalyzer::on_tracks(const pelorus::Event& event, const plr_tracks& message) {
    if (event.port == tracks && message.groups != nullptr) named_ = true;
    // A message of several times counts as one message of each.
    std::map<std::int64_t, std::vector<std::int64_t>> entries{{event.time, {}}};
    for (std::int64_t i = 0; i < message.count; ++i) entries[message.times[i]].push_back(i);
    for (const auto& [time, indices] : entries) {
        for (const std::int64_t i : indices) {
            if (event.port == groups)
                note(told_lives_, message, i);
            else
                take(message, i);
        }
        // A belated one tells of a past that nobody counts any more.
        if (event.port == tracks && (counts_.empty() || time >= counts_.rbegin()->first)) count(time);
    }
}

/// Entry i of tracks: it lives, in a group or in none, or it does not.
void GroupAnalyzer::take(const plr_tracks& message, std::int64_t i) {
    const std::uint64_t id = message.ids[i], group = message.groups == nullptr ? 0 : message.groups[i];
    if (!is_live(message.status[i])) {
        live_.erase(id);
        return;
    }
    note(track_lives_, message, i);
    live_[id] = group;
    if (group != 0) live(group_lives_, group, message.times[i]);
}

/// Entry i of a message whose entries are groups.
void GroupAnalyzer::note(Lives& lives, const plr_tracks& message, std::int64_t i) {
    if (!is_live(message.status[i])) return;
    Life& life = live(lives, message.ids[i], message.times[i]);
    if (message.parent_offsets == nullptr) return;
    for (std::int64_t k = message.parent_offsets[i]; k < message.parent_offsets[i + 1]; ++k)
        life.parents.insert(message.parents[k]);
}

/// The life of a group that is there at a time.
GroupAnalyzer::Life& GroupAnalyzer::live(Lives& lives, std::uint64_t id, std::int64_t time) {
    const auto [found, is_new] = lives.emplace(id, Life{});
    Life& life = found->second;
    life.start = is_new ? time : std::min(life.start, time);
    life.end = is_new ? time : std::max(life.end, time);
    return life;
}

void GroupAnalyzer::on_truth(const pelorus::Event&, const plr_truth& message) {
    if (!threshold_) return;
    const pelorus::Space space(*message.space);
    const auto coordinate = [&](std::int64_t i, const char* component) {
        const int row = space.index(component);
        return row < 0 ? 0.0 : message.state.data[i * message.state.item_stride + row * message.state.row_stride];
    };
    for (std::int64_t i = 0; i < message.count; ++i)
        places_[message.times[i]][message.ids[i]] = {coordinate(i, "position.x"), coordinate(i, "position.y"),
                                                     coordinate(i, "position.z")};
}

void GroupAnalyzer::finish(const pelorus::Event& event) {
    publish_counts(rows(), event.time);
    publish_lineage(event.time);
}

/// Counts what is live after the tracks of this time.
void GroupAnalyzer::count(std::int64_t time) {
    std::map<std::uint64_t, std::uint64_t> sizes;
    for (const auto& [track, group] : live_) ++sizes[group];
    Count& now = counts_[time];
    now.tracks = live_.size();
    now.unnamed = sizes.count(0) > 0 ? sizes.at(0) : 0;
    sizes.erase(0);
    now.groups = sizes.size();
    for (const auto& [group, size] : sizes) {
        Life& life = group_lives_[group];
        life.most_tracks = std::max(life.most_tracks, size);
    }
}

std::vector<GroupAnalyzer::Row> GroupAnalyzer::rows() const {
    std::vector<Row> out;
    for (const auto& [time, count] : counts_) {
        Row row{seconds(time), real(named_ ? count.groups : count.tracks), real(count.tracks), nothing, nothing};
        const auto found = places_.find(time);
        if (found != places_.end()) {
            std::vector<std::array<double, 3>> points;
            for (const auto& [id, place] : found->second) points.push_back({place.x, place.y, place.z});
            row.true_groups = static_cast<double>(partition::group_count(points, *threshold_));
            row.objects = real(points.size());
        }
        out.push_back(row);
    }
    return out;
}

/// Sum of the absolute steps of a column, those that end at variation_from or later.
double GroupAnalyzer::variation(const std::vector<Row>& rows, double Row::*column) const {
    double sum = 0;
    const Row* before = nullptr;
    for (const Row& row : rows) {
        if (std::isnan(row.*column)) continue;
        if (before != nullptr && row.time >= variation_from_) sum += std::fabs(row.*column - before->*column);
        before = &row;
    }
    return before == nullptr ? nothing : sum;
}

void GroupAnalyzer::publish_counts(const std::vector<Row>& rows, std::int64_t time) {
    pelorus::ResultBuilder table("by_time");
    table.column("time", "s", PLR_REDUCE_KEY);
    for (const char* name : {"groups", "tracks"}) table.column(name, "", PLR_REDUCE_MEAN);
    if (threshold_)
        for (const char* name : {"true_groups", "objects", "error"}) table.column(name, "", PLR_REDUCE_MEAN);
    for (const Row& row : rows) {
        std::vector<double> cells{row.time, row.groups, row.tracks};
        if (threshold_)
            for (const double value : {row.true_groups, row.objects, std::fabs(row.groups - row.true_groups)})
                cells.push_back(value);
        table.row(cells);
    }
    table.scalar("total_variation", "", PLR_REDUCE_MEAN, variation(rows, &Row::groups));
    if (threshold_) {
        table.scalar("true_total_variation", "", PLR_REDUCE_MEAN, variation(rows, &Row::true_groups));
        table.scalar_of_column("count_error", "", "error");
    }
    for (const double at : counts_at_) {
        // The last row up to then, unless the run was over before.
        const auto after = std::upper_bound(rows.begin(), rows.end(), at + 1e-9,
                                            [](double limit, const Row& row) { return limit < row.time; });
        const bool covered = after != rows.begin() && (after != rows.end() || rows.back().time >= at - 1e-9);
        const Row row = covered ? *(after - 1) : Row{at, nothing, nothing, nothing, nothing};
        table.scalar("count_at_" + name_of(at), "", PLR_REDUCE_MEAN, row.groups);
        if (threshold_) table.scalar("true_count_at_" + name_of(at), "", PLR_REDUCE_MEAN, row.true_groups);
    }
    publish(0, table.message(time));
}

void GroupAnalyzer::publish_lineage(std::int64_t time) {
    const Lives& lives = !told_lives_.empty() ? told_lives_ : named_ ? group_lives_ : track_lives_;
    pelorus::ResultBuilder table("lineage");
    table.column("row", "", PLR_REDUCE_KEY);
    table.column("group", "", PLR_REDUCE_FIRST_RUN);
    table.column("start", "s", PLR_REDUCE_FIRST_RUN);
    table.column("end", "s", PLR_REDUCE_FIRST_RUN);
    table.column("most_tracks", "", PLR_REDUCE_FIRST_RUN);
    table.column("parent", "", PLR_REDUCE_FIRST_RUN);
    double row = 0;
    for (const auto& [id, life] : lives) {
        const auto named = group_lives_.find(id);
        const std::uint64_t most = named == group_lives_.end() ? life.most_tracks : named->second.most_tracks;
        const auto add = [&](double parent) {
            table.row({row++, real(id), seconds(life.start), seconds(life.end), real(most), parent});
        };
        if (life.parents.empty()) add(nothing);
        for (const std::uint64_t parent : life.parents) add(real(parent));
    }
    table.scalar("groups_ever", "", PLR_REDUCE_MEAN, real(lives.size()));
    publish(0, table.message(time));
}

}  // namespace analyzer_groups
