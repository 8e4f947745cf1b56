/// Who came from whom: splits and mergers, as the column `parents` of a table of tracks tells them.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pelorus::report {

/// One row of a table of tracks, as far as its lineage goes.
struct Sighting {
    double time = 0;          ///< s
    std::string id, parents;  ///< parents: ids with blanks between
};

/// Who was there when, and whose child it became when; null where nobody has a parent.
///
///     [{id, spans: [[from, to], ..], parents: [[id, time], ..]}]
///
/// In the order of a tree: children stand below the first of their parents. Who is absorbed (became a parent of one that was there before) and told
/// again later has a gap between. `sightings` ascend in time. At most `most_relatives` are told, those first seen.
nlohmann::ordered_json lineage_json(const std::vector<Sighting>& sightings);

constexpr std::size_t most_relatives = 300;

}  // namespace pelorus::report
