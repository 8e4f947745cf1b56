#include "report/lineage.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

namespace pelorus::report {

namespace {

using Json = nlohmann::ordered_json;

struct Relative {
    std::vector<double> times;
    std::vector<std::pair<std::string, double>> parents;  // id, when it was told first
};

struct Family {
    std::map<std::string, Relative> relatives;
    std::vector<std::string> order;                   // of first sightings
    std::map<std::string, std::vector<double>> gone;  // when somebody was absorbed by another one
    bool has_parents = false;
};

Family family_of(const std::vector<Sighting>& sightings) {
    Family family;
    for (const Sighting& sighting : sightings) {
        const auto [found, is_new] = family.relatives.try_emplace(sighting.id);
        if (is_new) family.order.push_back(sighting.id);
        Relative& relative = found->second;
        relative.times.push_back(sighting.time);
        std::istringstream words(sighting.parents);
        for (std::string parent; words >> parent;) {
            const auto same = [&](const auto& known) { return known.first == parent; };
            if (std::any_of(relative.parents.begin(), relative.parents.end(), same)) continue;
            relative.parents.emplace_back(parent, sighting.time);
            family.has_parents = true;
            if (!is_new) family.gone[parent].push_back(sighting.time);  // else it has lost a part
        }
    }
    return family;
}

/// Spans in which it was told, with gaps where it was a part of another one.
Json spans_of(const Relative& relative, const std::vector<double>& gone) {
    Json spans = Json::array();
    double from = relative.times.front(), last = from;
    for (const double time : relative.times) {
        const bool was_away = std::any_of(gone.begin(), gone.end(), [&](double t) { return t > last && t < time; });
        if (was_away) {
            spans.push_back({from, last});
            from = time;
        }
        last = time;
    }
    spans.push_back({from, last});
    return spans;
}

/// Depth first: each below the first of its parents that was there before it.
std::vector<std::string> tree_order(const Family& family) {
    std::map<std::string, std::vector<std::string>> children;
    std::vector<std::string> open, ordered;
    for (const std::string& id : family.order) {
        const Relative& relative = family.relatives.at(id);
        std::string parent;
        for (const auto& [candidate, time] : relative.parents) {
            const auto known = family.relatives.find(candidate);
            if (parent.empty() && time <= relative.times.front() && known != family.relatives.end() &&
                known->second.times.front() < relative.times.front())
                parent = candidate;
        }
        children[parent].push_back(id);
    }
    const auto push = [&](const std::string& of) {
        const std::vector<std::string>& below = children[of];
        open.insert(open.end(), below.rbegin(), below.rend());
    };
    push("");
    while (!open.empty()) {
        ordered.push_back(open.back());
        open.pop_back();
        push(ordered.back());
    }
    return ordered;
}

}  // namespace

Json lineage_json(const std::vector<Sighting>& sightings) {
    const Family family = family_of(sightings);
    if (!family.has_parents) return nullptr;
    const std::set<std::string> told(
        family.order.begin(),
        family.order.begin() + static_cast<std::ptrdiff_t>(std::min(family.order.size(), most_relatives)));
    Json lineage = Json::array();
    for (const std::string& id : tree_order(family)) {
        if (told.count(id) == 0) continue;
        const Relative& relative = family.relatives.at(id);
        const auto gone = family.gone.find(id);
        Json parents = Json::array();
        for (const auto& [parent, time] : relative.parents) parents.push_back({parent, time});
        lineage.push_back(
            {{"id", id},
             {"spans", spans_of(relative, gone == family.gone.end() ? std::vector<double>() : gone->second)},
             {"parents", parents}});
    }
    return lineage;
}

}  // namespace pelorus::report
