/// Tracks of two trackers that follow the same objects: who is whom, and what the fused tracks are called.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "gathering.hpp"
#include "matching.hpp"

namespace fusion {

/// What follows one object: places in the lists of the two sides, -1: none there.
struct Pair {
    int first = -1, second = -1;
    std::uint64_t id = 0;  ///< of the fused track
};

/// Keeps pairs and names from one time to the next. What it holds grows with the tracks that there are, and with no others.
class TrackPairs {
public:
    /// Pairs the tracks of two sides; nullptr: that side has not told. Pairs of the time before stay together as long as they are
    /// within the gate (a squared distance); the others meet at the least sum of squared distances.
    std::vector<Pair> pair(const CommonSpace& common, const Sight* first, const Sight* second, double gate) {
        const std::vector<Sighting> none;
        const auto& a = first != nullptr ? first->sightings : none;
        const auto& b = second != nullptr ? second->sightings : none;
        std::vector<std::int64_t> partner(a.size(), assignment::unassigned);
        std::vector<bool> is_taken(b.size());
        keep_together(common, a, b, gate, partner, is_taken);
        meet(common, a, b, gate, partner, is_taken);
        std::vector<Pair> out;
        for (std::size_t i = 0; i < a.size(); ++i)
            out.push_back({static_cast<int>(i), static_cast<int>(partner[i]), 0});
        for (std::size_t j = 0; j < b.size(); ++j)
            if (!is_taken[j]) out.push_back({-1, static_cast<int>(j), 0});
        name(out, a, b);
        forget(first, second);
        return out;
    }

    template <class Archive> void state(Archive& archive) { archive(together_, names_, next_); }

private:
    using Key = std::pair<std::int32_t, std::uint64_t>;  ///< side, its id

    static Piece piece(const CommonSpace& common, const Sighting& track) {
        Piece out{{}, track.value, track.covariance};
        for (int c = 0; c < common.size(); ++c) out.places.push_back(c);
        return out;
    }

    void keep_together(const CommonSpace& common, const std::vector<Sighting>& a, const std::vector<Sighting>& b,
                       double gate, std::vector<std::int64_t>& partner, std::vector<bool>& is_taken) const {
        for (std::size_t i = 0; i < a.size(); ++i) {
            const auto known = together_.find(a[i].id);
            for (std::size_t j = 0; known != together_.end() && j < b.size(); ++j) {
                int shared = 0;
                if (b[j].id != known->second || is_taken[j] ||
                    distance(common, piece(common, a[i]), piece(common, b[j]), shared) > gate)
                    continue;
                partner[i] = static_cast<std::int64_t>(j);
                is_taken[j] = true;
            }
        }
    }

    void meet(const CommonSpace& common, const std::vector<Sighting>& a, const std::vector<Sighting>& b, double gate,
              std::vector<std::int64_t>& partner, std::vector<bool>& is_taken) {
        std::vector<std::size_t> rows, columns;
        std::vector<Piece> row_pieces, column_pieces;
        for (std::size_t i = 0; i < a.size(); ++i)
            if (partner[i] == assignment::unassigned) rows.push_back(i), row_pieces.push_back(piece(common, a[i]));
        for (std::size_t j = 0; j < b.size(); ++j)
            if (!is_taken[j]) columns.push_back(j), column_pieces.push_back(piece(common, b[j]));
        std::vector<const Piece*> row_list, column_list;
        for (const Piece& each : row_pieces) row_list.push_back(&each);
        for (const Piece& each : column_pieces) column_list.push_back(&each);
        const auto met = match(common, row_list, column_list, gate);
        for (std::size_t r = 0; r < rows.size(); ++r) {
            if (met[r] == assignment::unassigned) continue;
            const std::size_t j = columns[static_cast<std::size_t>(met[r])];
            partner[rows[r]] = static_cast<std::int64_t>(j);
            is_taken[j] = true;
        }
        for (std::size_t i = 0; i < a.size(); ++i)
            if (partner[i] != assignment::unassigned) together_[a[i].id] = b[static_cast<std::size_t>(partner[i])].id;
    }

    /// A pair has the name of its first track; who parts from a pair gets another one.
    void name(std::vector<Pair>& pairs, const std::vector<Sighting>& a, const std::vector<Sighting>& b) {
        std::set<std::uint64_t> used;
        for (Pair& pair : pairs) {
            const Key first{0, pair.first < 0 ? 0 : a[static_cast<std::size_t>(pair.first)].id},
                second{1, pair.second < 0 ? 0 : b[static_cast<std::size_t>(pair.second)].id};
            for (const Key& key : {first, second}) {
                const bool is_there = key.first == 0 ? pair.first >= 0 : pair.second >= 0;
                const auto known = names_.find(key);
                if (pair.id == 0 && is_there && known != names_.end() && used.count(known->second) == 0)
                    pair.id = known->second;
            }
            if (pair.id == 0) pair.id = next_++;
            used.insert(pair.id);
            if (pair.first >= 0) names_[first] = pair.id;
            if (pair.second >= 0) names_[second] = pair.id;
        }
    }

    /// Tracks that a side tells of no longer are gone.
    void forget(const Sight* first, const Sight* second) {
        for (const auto& [side, sight] : {std::pair(0, first), std::pair(1, second)}) {
            if (sight == nullptr) continue;
            std::set<std::uint64_t> there;
            for (const Sighting& track : sight->sightings) there.insert(track.id);
            for (auto at = names_.begin(); at != names_.end();)
                at = at->first.first == side && there.count(at->first.second) == 0 ? names_.erase(at) : std::next(at);
            for (auto at = together_.begin(); at != together_.end();)
                at = there.count(side == 0 ? at->first : at->second) == 0 ? together_.erase(at) : std::next(at);
        }
    }

    std::map<std::uint64_t, std::uint64_t> together_;  ///< first's id -> second's
    std::map<Key, std::uint64_t> names_;
    std::uint64_t next_ = 1;
};

}  // namespace fusion
