#include "graph/settings.hpp"

#include <algorithm>
#include <charconv>
#include <vector>

#include "graph/units.hpp"

namespace pelorus::graph {

namespace {

const std::vector<std::string> top_keys{"pelorus", "title", "run", "frames", "graph", "campaign", "extend"};

void check_keys(const Value& map, const std::vector<std::string>& keys, const std::string& prefix, Problems& problems) {
    for (const Value::Entry& entry : map.map)
        if (entry.key.compare(0, 2, "x-") != 0 || !prefix.empty())
            if (std::find(keys.begin(), keys.end(), entry.key) == keys.end())
                problems.add(entry.where,
                             prefix + "unknown key '" + entry.key + "'" + suggestion(entry.key, keys, "keys"));
}

void check_version(const Value& root, Problems& problems) {
    const Value* version = root.find("pelorus");
    if (version == nullptr)
        problems.add(root.where, "a config says which version it is written for: `pelorus: 1` is missing");
    else if (!version->is_scalar() || version->scalar != "1")
        problems.add(version->where, "pelorus: this host reads version 1 of the config, got " + version->described());
}

std::optional<std::uint64_t> read_seed(const Value& root, Problems& problems) {
    const Value* run = root.find("run");
    if (run == nullptr) return std::nullopt;
    if (!run->is_map()) {
        problems.add(run->where, "run: expected a map such as {seed: 7}, got " + run->described());
        return std::nullopt;
    }
    check_keys(*run, {"seed"}, "run: ", problems);
    const Value* text = run->find("seed");
    if (text == nullptr) return std::nullopt;
    std::uint64_t seed = 0;
    const char* first = text->scalar.data();
    const char* last = first + text->scalar.size();
    const auto [end, error] = std::from_chars(first, last, seed);
    if (text->is_scalar() && error == std::errc() && end == last) return seed;
    problems.add(text->where, "run.seed: expected a whole number from 0 to 2^64 - 1, got " + text->described());
    return std::nullopt;
}

void check_axis(const Value::Entry& axis, Problems& problems) {
    const std::string label = "campaign.sweep." + axis.key + ": ";
    if (axis.value.is_list() && !axis.value.list.empty()) return;
    if (!axis.value.is_map() || axis.value.map.empty()) {
        problems.add(axis.value.where,
                     label + "expected a list of values, or a map from addresses to lists of one length, got " +
                         (axis.value.is_list() ? "an empty list" : axis.value.described()));
        return;
    }
    const std::size_t length = axis.value.map.front().value.list.size();
    for (const Value::Entry& entry : axis.value.map) {
        if (!entry.value.is_list() || entry.value.list.empty())
            problems.add(entry.value.where,
                         label + entry.key + ": expected a list of values, got " + entry.value.described());
        else if (entry.value.list.size() != length)
            problems.add(entry.value.where, label + entry.key + " has " + std::to_string(entry.value.list.size()) +
                                                " values, " + axis.value.map.front().key + " has " +
                                                std::to_string(length));
    }
}

void check_campaign(const Value* campaign, Problems& problems) {
    if (campaign == nullptr) return;
    if (!campaign->is_map()) {
        problems.add(campaign->where,
                     "campaign: expected a map with runs, sweep, variants, got " + campaign->described());
        return;
    }
    check_keys(*campaign, {"runs", "sweep", "variants"}, "campaign: ", problems);
    if (const Value* runs = campaign->find("runs")) {
        bool is_positive = false;
        try {
            is_positive = runs->is_scalar() && parse_integer(runs->scalar) > 0;
        } catch (const UnitError&) {
            is_positive = false;
        }
        if (!is_positive)
            problems.add(runs->where, "campaign.runs: expected a whole number of at least 1, got " + runs->described());
    }
    if (const Value* sweep = campaign->find("sweep")) {
        if (!sweep->is_map())
            problems.add(sweep->where,
                         "campaign.sweep: expected a map from addresses to lists of values, got " + sweep->described());
        for (const Value::Entry& axis : sweep->map) check_axis(axis, problems);
    }
    if (const Value* variants = campaign->find("variants")) {
        if (!variants->is_map())
            problems.add(variants->where,
                         "campaign.variants: expected a map from names to overrides, got " + variants->described());
        for (const Value::Entry& variant : variants->map)
            if (!variant.value.is_map())
                problems.add(variant.value.where, "campaign.variants." + variant.key +
                                                      ": expected a map from addresses to values ({} for none), got " +
                                                      variant.value.described());
    }
}

}  // namespace

Settings read_settings(const Value& root, Problems& problems) {
    check_keys(root, top_keys, "", problems);
    check_version(root, problems);
    Settings settings;
    if (const Value* title = root.find("title")) {
        if (title->is_scalar())
            settings.title = title->scalar;
        else
            problems.add(title->where, "title: expected a text, got " + title->described());
    }
    settings.seed = read_seed(root, problems);
    check_campaign(root.find("campaign"), problems);
    return settings;
}

}  // namespace pelorus::graph
