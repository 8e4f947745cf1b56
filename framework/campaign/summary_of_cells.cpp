#include "campaign/summary_of_cells.hpp"

#include <map>
#include <utility>

#include "campaign/finished_cell.hpp"

namespace pelorus::campaign {

nlohmann::ordered_json summary_of_cells(const Store& store, const std::vector<std::size_t>& cells,
                                        const std::string& reference) {
    using Json = nlohmann::ordered_json;
    std::map<std::string, std::size_t> references;  // by sweep
    std::vector<std::size_t> others;
    Json document{{"cells", Json::array()}};
    std::map<std::size_t, std::size_t> places;
    for (const std::size_t index : cells) {
        if (!store.has_cell(index)) continue;
        Json cell = std::move(store.cell(index)["cell"]);
        if (cell.at("variant") == reference)
            references.emplace(cell.at("sweep").dump(), index);
        else
            others.push_back(index);
        places[index] = document["cells"].size();
        document["cells"].push_back(std::move(cell));
    }
    for (const std::size_t index : others) {
        Json& entry = document["cells"][places.at(index)];
        const auto found = references.find(entry.at("sweep").dump());
        if (found == references.end()) continue;
        entry["paired"] = {{"reference", reference},
                           {"scalars", paired_differences(store.cell(index), store.cell(found->second))}};
    }
    return document;
}

}  // namespace pelorus::campaign
