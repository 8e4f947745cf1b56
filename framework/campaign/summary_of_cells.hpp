/// summary.json of a campaign, from the cells that are kept.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "campaign/store.hpp"

namespace pelorus::campaign {

/// Of those of `cells` that the store has. A cell of another variant than `reference` has `paired`, if the reference has a cell with
/// the same sweep: the differences of the scalars. Throws Error: a cell cannot be read.
nlohmann::ordered_json summary_of_cells(const Store& store, const std::vector<std::size_t>& cells,
                                        const std::string& reference);

}  // namespace pelorus::campaign
