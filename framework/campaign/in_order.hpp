/// Two sequences become one in which everything stands once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

namespace pelorus::campaign {

/// Where in a sequence a key stands. The keys are put in order when the first one is asked for.
template <class T, class KeyOf> class Places {
public:
    Places(const std::vector<T>& all, KeyOf key_of) : all_(all), key_of_(key_of) {}

    /// all.size() where no element has it.
    template <class Key> std::size_t of(const Key& key) {
        if (sorted_.empty() && !all_.empty()) sort();
        const auto found =
            std::lower_bound(sorted_.begin(), sorted_.end(), key,
                             [&](std::size_t at, const Key& wanted) { return key_of_(all_[at]) < wanted; });
        return found == sorted_.end() || key < key_of_(all_[*found]) ? all_.size() : *found;
    }

private:
    void sort() {
        sorted_.resize(all_.size());
        std::iota(sorted_.begin(), sorted_.end(), std::size_t{0});
        std::sort(sorted_.begin(), sorted_.end(),
                  [&](std::size_t a, std::size_t b) { return key_of_(all_[a]) < key_of_(all_[b]); });
    }

    const std::vector<T>& all_;
    KeyOf key_of_;
    std::vector<std::size_t> sorted_;
};

/// Joins each of `later` with the one of `into` that has its key; one that has none is put behind what came before it. Keys are
/// unique in each of the two, and joining leaves them as they are. Where both sequences are alike, as they are in all but odd cases, nothing is searched; else it
/// costs n log n.
template <class T, class KeyOf, class Join>
void merge_in_order(std::vector<T>& into, std::vector<T> later, KeyOf key_of, Join join) {
    struct New {
        std::size_t before, number;  // the element of `into` that it comes to stand before; among `later`
    };
    std::vector<New> added;
    Places<T, KeyOf> places(into, key_of);
    std::size_t place = 0;
    for (std::size_t i = 0; i < later.size(); ++i) {
        const auto& key = key_of(later[i]);
        const bool is_next = place < into.size() && key_of(into[place]) == key;
        const std::size_t at = is_next ? place : places.of(key);
        if (at < into.size()) {
            join(into[at], std::move(later[i]));
            place = at + 1;
        } else {
            added.push_back({place, i});
        }
    }
    if (added.empty()) return;
    std::stable_sort(added.begin(), added.end(), [](const New& a, const New& b) { return a.before < b.before; });
    std::vector<T> all;
    all.reserve(into.size() + added.size());
    auto next = added.begin();
    for (std::size_t at = 0; at <= into.size(); ++at) {
        for (; next != added.end() && next->before == at; ++next) all.push_back(std::move(later[next->number]));
        if (at < into.size()) all.push_back(std::move(into[at]));
    }
    into = std::move(all);
}

}  // namespace pelorus::campaign
