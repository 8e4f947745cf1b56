#include "campaign/cells.hpp"

#include <algorithm>
#include <utility>

#include "graph/names.hpp"

namespace pelorus::campaign {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_cells = 1'000'000;

/// Whether an override of `address` leaves a value at `axis` without effect.
bool covers(const std::string& address, const std::string& axis) {
    return axis == address || axis.compare(0, address.size() + 1, address + ".") == 0;
}

void remove_axes(std::vector<graph::Axis>& axes, const std::vector<graph::Assignment>& overrides) {
    const auto is_covered = [&](const graph::Axis& axis) {
        for (const graph::Axis::Series& series : axis.series)
            for (const graph::Assignment& each : overrides)
                if (covers(each.address, series.address)) return true;
        return false;
    };
    axes.erase(std::remove_if(axes.begin(), axes.end(), is_covered), axes.end());
}

std::vector<graph::Variant> chosen_variants(const std::vector<graph::Variant>& all, const Selection& selection,
                                            graph::Problems& problems) {
    const std::vector<graph::Variant> there = all.empty() ? std::vector<graph::Variant>{{"default", {}}} : all;
    if (selection.variants.empty()) return there;
    std::vector<std::string> names;
    for (const graph::Variant& variant : there) names.push_back(variant.name);
    for (const std::string& name : selection.variants)
        if (std::find(names.begin(), names.end(), name) == names.end())
            problems.add({"--variant " + name, 0, 0},
                         "there is no variant '" + name + "'" + graph::suggestion(name, names, "variants"));
    std::vector<graph::Variant> chosen;
    for (const graph::Variant& variant : there)
        if (std::find(selection.variants.begin(), selection.variants.end(), variant.name) != selection.variants.end())
            chosen.push_back(variant);
    return chosen;
}

/// Every point of the grid, the last axis fastest.
void add_cells(const graph::Variant& variant, const std::vector<graph::Axis>& axes, std::vector<Cell>& cells) {
    std::vector<std::size_t> point(axes.size(), 0);
    while (true) {
        Cell cell;
        cell.index = cells.size();
        cell.variant = variant.name;
        cell.overrides = variant.overrides;
        for (std::size_t i = 0; i < axes.size(); ++i)
            for (const graph::Axis::Series& series : axes[i].series)
                cell.sweep.push_back(graph::override_of(series.address, series.where, series.values[point[i]]));
        cells.push_back(std::move(cell));
        std::size_t axis = axes.size();
        while (axis > 0 && ++point[axis - 1] == axes[axis - 1].size()) point[--axis] = 0;
        if (axis == 0) return;
    }
}

bool fits(const std::vector<graph::Axis>& axes, std::size_t there) {
    std::size_t count = 1;
    for (const graph::Axis& axis : axes) {
        if (axis.size() > most_cells / count) return false;
        count *= axis.size();
    }
    return there + count <= most_cells;
}

Json written(const graph::Value& value) {
    Json json;
    if (value.is_scalar()) return value.scalar;
    if (value.is_list()) {
        json = Json::array();
        for (const graph::Value& each : value.list) json.push_back(written(each));
    }
    if (value.is_map()) {
        json = Json::object();
        for (const graph::Value::Entry& entry : value.map) json[entry.key] = written(entry.value);
    }
    return json;
}

bool has_number(const Json& json) {
    if (json.is_structured()) return std::any_of(json.begin(), json.end(), has_number);
    return json.is_number() || json.is_boolean();
}

}  // namespace

Plan plan_cells(const graph::Document& document, const Selection& selection, graph::Problems& problems) {
    Plan plan;
    const std::size_t before = problems.count();
    graph::CampaignBlock block = graph::read_campaign(document.campaign(), problems);
    plan.runs = selection.runs.value_or(block.runs);
    plan.goes_on = block.goes_on;
    const std::vector<graph::Variant> variants = chosen_variants(block.variants, selection, problems);
    if (problems.count() != before) return plan;
    const auto is_chosen = [&](const std::string& name) {
        return std::any_of(variants.begin(), variants.end(), [&](const auto& variant) { return variant.name == name; });
    };
    plan.reference = is_chosen(block.reference) ? block.reference : variants.front().name;
    remove_axes(block.axes, document.overrides());
    for (const graph::Variant& variant : variants) {
        std::vector<graph::Axis> axes = block.axes;
        remove_axes(axes, variant.overrides);
        if (!fits(axes, plan.cells.size())) {
            problems.add(document.campaign()->where,
                         "campaign: more than " + std::to_string(most_cells) + " variants and grid points");
            return plan;
        }
        add_cells(variant, axes, plan.cells);
    }
    return plan;
}

graph::Document document_of(const graph::Document& document, const Cell& cell) {
    graph::Document made = document.without_campaign();
    for (const graph::Assignment& each : cell.sweep) made.assign(each);
    for (const graph::Assignment& each : cell.overrides) made.assign(each);
    return made;
}

Json value_at(const Json& resolved, const std::string& address) {
    const std::vector<std::string> segments = graph::split_address(address);
    if (segments.front() == "run") return resolved.at("run").at("seed");
    const Json* at = &resolved.at("graph");
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const std::string& key = segments[i];
        const auto below = [&](const char* map) -> const Json* {
            const auto found = at->find(map);
            if (found == at->end() || !found->is_object()) return nullptr;
            const auto entry = found->find(key);
            return entry == found->end() ? nullptr : &*entry;
        };
        const Json* next = at->is_object() && at->contains(key) ? &(*at)[key] : nullptr;
        if (next == nullptr && i + 1 == segments.size()) next = below("with");
        if (next == nullptr) next = below("parts");
        if (next == nullptr) return nullptr;
        at = next;
    }
    return *at;
}

Json sweep_json(const Cell& cell, const Json& resolved) {
    Json sweep = Json::object();
    for (const graph::Assignment& each : cell.sweep) {
        // Numbers are in SI then. Texts are as they were written: a path would otherwise tell where this machine has it.
        Json value = value_at(resolved, each.address);
        // A parameter that takes several numbers and got one is a list then; the summary has it as it was written.
        if (each.value.is_scalar() && value.is_array() && value.size() == 1) value = Json(value.front());
        sweep[each.address] = !value.is_object() && has_number(value) ? std::move(value) : written(each.value);
    }
    return sweep;
}

std::string cell_text(const Cell& cell) {
    std::string text = "variant " + cell.variant;
    for (const graph::Assignment& each : cell.sweep) {
        const Json value = written(each.value);
        text += ", " + each.address + " = " + (value.is_string() ? value.get<std::string>() : value.dump());
    }
    return text;
}

}  // namespace pelorus::campaign
