#include "tally.hpp"

#include <algorithm>

namespace analyzer_identity {

std::uint64_t Shares::count(std::uint64_t who) const {
    const auto found = counts_.find(who);
    return found == counts_.end() ? 0 : found->second;
}

std::uint64_t Shares::total() const {
    std::uint64_t sum = 0;
    for (const auto& [who, count] : counts_) sum += count;
    return sum;
}

std::optional<std::uint64_t> Shares::main() const {
    const auto most = std::max_element(counts_.begin(), counts_.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == counts_.end() ? std::nullopt : std::optional<std::uint64_t>(most->first);
}

double purity(const Follower& track) {
    const auto main = track.identities.main();
    if (track.measurements == 0 || !main) return 0;
    return static_cast<double>(track.identities.count(*main)) / static_cast<double>(track.measurements);
}

void Tally::report(std::uint64_t identity, std::uint64_t measurement, std::int64_t time) {
    if (!open_.emplace(measurement, Report{identity, std::nullopt}).second) return;
    identities_[identity];
    queue_.emplace_back(time, measurement);
}

void Tally::entry(std::uint64_t track, std::int64_t time) {
    const auto [found, is_new] = tracks_.try_emplace(track);
    if (is_new) found->second.start = time;
    found->second.end = std::max(time, is_new ? time : found->second.end);
}

void Tally::use(std::uint64_t track, std::uint64_t measurement) {
    Follower& follower = tracks_[track];
    ++follower.measurements;
    const auto found = open_.find(measurement);
    if (found == open_.end()) {
        ++follower.unknown;
        return;
    }
    follower.identities.add(found->second.identity);
    if (!found->second.track) found->second.track = track;
}

void Tally::judge(std::int64_t time) {
    while (!queue_.empty() && queue_.front().first < time) judge_first();
}

void Tally::judge_all() {
    while (!queue_.empty()) judge_first();
}

void Tally::judge_first() {
    const auto [time, measurement] = queue_.front();
    const auto found = open_.find(measurement);
    queue_.pop_front();
    const Report report = found->second;
    open_.erase(found);
    Followed& identity = identities_[report.identity];
    if (identity.reports++ == 0) identity.first = time;
    if (!report.track) {
        identity.broken_off = identity.last_track.has_value();
        return;
    }
    if (identity.tracked++ == 0) identity.first_tracked = time;
    identity.tracks.add(*report.track);
    if (identity.last_track && identity.last_track != report.track) ++identity.switches;
    if (identity.broken_off) ++identity.fragments;
    identity.last_track = report.track;
    identity.broken_off = false;
}

}  // namespace analyzer_identity
