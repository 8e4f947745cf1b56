/// Two sequences become one in which everything stands once.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace pelorus::campaign {

/// Joins each of `later` with its equal in `into`; one that has none is put behind what came before it. Where both sequences are
/// alike, as they are in all but odd cases, nothing is searched.
template <class T, class Same, class Join>
void merge_in_order(std::vector<T>& into, std::vector<T> later, Same same, Join join) {
    std::size_t place = 0;
    for (T& one : later) {
        std::size_t at = place;
        if (at >= into.size() || !same(into[at], one)) {
            at = 0;
            while (at < into.size() && !same(into[at], one)) ++at;
        }
        if (at < into.size()) {
            join(into[at], std::move(one));
            place = at + 1;
        } else {
            into.insert(into.begin() + static_cast<std::ptrdiff_t>(place), std::move(one));
            ++place;
        }
    }
}

}  // namespace pelorus::campaign
