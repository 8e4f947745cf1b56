/// Clusters of an association: tracks that share detections, directly or through others, and can only be decided together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace assignment {

/// Connected components by union and find.
class Components {
public:
    explicit Components(std::size_t size) : parent_(size) {
        for (std::size_t i = 0; i < size; ++i) parent_[i] = i;
    }
    std::size_t root(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) {
        a = root(a), b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::size_t> parent_;
};

/// Indices of the pairs of each cluster, ascending, clusters in the order of their first track. A Pair has `track` and
/// `detection`; pairs are in ascending order of track.
template <class Pair> std::vector<std::vector<std::size_t>> clusters(const std::vector<Pair>& pairs) {
    std::size_t most = 0;
    for (const Pair& pair : pairs) most = std::max(most, pair.detection + 1);
    constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    Components components(pairs.size());
    std::vector<std::size_t> first_of(most, none);  // a pair of each detection
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (i > 0 && pairs[i - 1].track == pairs[i].track) components.join(i - 1, i);
        std::size_t& first = first_of[pairs[i].detection];
        if (first == none)
            first = i;
        else
            components.join(first, i);
    }
    std::vector<std::vector<std::size_t>> out;
    std::vector<std::size_t> place(pairs.size(), none);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const std::size_t root = components.root(i);
        if (place[root] == none) {
            place[root] = out.size();
            out.emplace_back();
        }
        out[place[root]].push_back(i);
    }
    return out;
}

}  // namespace assignment
