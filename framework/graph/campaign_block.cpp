#include "graph/campaign_block.hpp"

#include <algorithm>
#include <utility>

#include "graph/units.hpp"

namespace pelorus::graph {

namespace {

std::uint64_t read_runs(const Value& runs, Problems& problems) {
    std::int64_t number = 0;
    try {
        if (runs.is_scalar()) number = parse_integer(runs.scalar);
    } catch (const UnitError&) {
        number = 0;
    }
    if (number > 0) return static_cast<std::uint64_t>(number);
    problems.add(runs.where, "campaign.runs: expected a whole number of at least 1, got " + runs.described());
    return 1;
}

bool is_filled_list(const Value& value) { return value.is_list() && !value.list.empty(); }

/// An axis is a list of values under its address, or a map from addresses to lists of one length.
Axis read_axis(const Value::Entry& entry, Problems& problems) {
    const std::string label = "campaign.sweep." + entry.key + ": ";
    Axis axis;
    axis.name = entry.key;
    if (is_filled_list(entry.value)) {
        axis.series.push_back({entry.key, entry.where, entry.value.list});
        return axis;
    }
    if (!entry.value.is_map() || entry.value.map.empty()) {
        problems.add(entry.value.where,
                     label + "expected a list of values, or a map from addresses to lists of one length, got " +
                         (entry.value.is_list() ? "an empty list" : entry.value.described()));
        return axis;
    }
    const Value::Entry& first = entry.value.map.front();
    for (const Value::Entry& series : entry.value.map) {
        if (!is_filled_list(series.value))
            problems.add(series.value.where,
                         label + series.key + ": expected a list of values, got " + series.value.described());
        else if (series.value.list.size() != first.value.list.size())
            problems.add(series.value.where, label + series.key + " has " + std::to_string(series.value.list.size()) +
                                                 " values, " + first.key + " has " +
                                                 std::to_string(first.value.list.size()));
        axis.series.push_back({series.key, series.where, series.value.list});
    }
    return axis;
}

void check_addresses(const std::vector<Axis>& axes, Problems& problems) {
    std::vector<std::string> seen;
    for (const Axis& axis : axes)
        for (const Axis::Series& series : axis.series) {
            if (std::find(seen.begin(), seen.end(), series.address) != seen.end())
                problems.add(series.where, "campaign.sweep: " + series.address + " stands in two axes");
            seen.push_back(series.address);
        }
}

std::vector<Axis> read_sweep(const Value& sweep, Problems& problems) {
    std::vector<Axis> axes;
    if (!sweep.is_map())
        problems.add(sweep.where,
                     "campaign.sweep: expected a map from addresses to lists of values, got " + sweep.described());
    for (const Value::Entry& entry : sweep.map) axes.push_back(read_axis(entry, problems));
    check_addresses(axes, problems);
    return axes;
}

/// Names of variants are words of the command line and of file names.
bool is_variant_name(const std::string& name) {
    return !name.empty() && name.front() != '-' && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
               c == '.' || c == '+';
    });
}

std::vector<Variant> read_variants(const Value& block, Problems& problems) {
    std::vector<Variant> variants;
    if (!block.is_map())
        problems.add(block.where,
                     "campaign.variants: expected a map from names to overrides, got " + block.described());
    for (const Value::Entry& entry : block.map) {
        const std::string label = "campaign.variants." + entry.key + ": ";
        if (!is_variant_name(entry.key))
            problems.add(entry.where, "campaign.variants: '" + entry.key +
                                          "' cannot name a variant: letters, digits, _, -, + and . only, no - first");
        if (!entry.value.is_map())
            problems.add(entry.value.where, label + "expected a map from addresses to values ({} for none), got " +
                                                entry.value.described());
        Variant variant;
        variant.name = entry.key;
        for (const Value::Entry& each : entry.value.map)
            variant.overrides.push_back(override_of(each.key, each.where, each.value));
        variants.push_back(std::move(variant));
    }
    return variants;
}

std::string read_reference(const Value* named, const std::vector<Variant>& variants, Problems& problems) {
    std::vector<std::string> names;
    for (const Variant& variant : variants) names.push_back(variant.name);
    if (named == nullptr) return names.empty() ? "" : names.front();
    if (!named->is_scalar() || named->scalar.empty())
        problems.add(named->where, "campaign.reference: expected the name of a variant, got " + named->described());
    else if (std::find(names.begin(), names.end(), named->scalar) == names.end())
        problems.add(named->where, "campaign.reference: there is no variant '" + named->scalar + "'" +
                                       suggestion(named->scalar, names, "variants"));
    return named->scalar;
}

bool read_on_failure(const Value* policy, Problems& problems) {
    if (policy == nullptr) return false;
    const std::vector<std::string> words{"stop", "continue"};
    const bool known = policy->is_scalar() && std::find(words.begin(), words.end(), policy->scalar) != words.end();
    if (!known) {
        const std::string near = policy->is_scalar() ? meant(policy->scalar, words) : std::string();
        problems.add(policy->where, "campaign.on_failure: expected one of stop, continue, got " + policy->described() +
                                        (near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    return policy->scalar == "continue";
}

}  // namespace

Assignment override_of(const std::string& address, const Location& where, Value value) {
    if (!value.is_null()) return {address, where, std::move(value)};
    const Location place{where.text(), 0, 0};
    value.where = place;
    return {address, place, std::move(value)};
}

CampaignBlock read_campaign(const Value* block, Problems& problems) {
    CampaignBlock campaign;
    if (block == nullptr) return campaign;
    if (!block->is_map()) {
        problems.add(block->where, "campaign: expected a map with runs, sweep, variants, got " + block->described());
        return campaign;
    }
    check_keys(*block, {"runs", "sweep", "variants", "reference", "on_failure"}, "campaign: ", problems);
    if (const Value* runs = block->find("runs")) campaign.runs = read_runs(*runs, problems);
    if (const Value* sweep = block->find("sweep")) campaign.axes = read_sweep(*sweep, problems);
    if (const Value* variants = block->find("variants")) campaign.variants = read_variants(*variants, problems);
    campaign.reference = read_reference(block->find("reference"), campaign.variants, problems);
    campaign.goes_on = read_on_failure(block->find("on_failure"), problems);
    return campaign;
}

}  // namespace pelorus::graph
