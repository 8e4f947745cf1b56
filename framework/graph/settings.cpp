#include "graph/settings.hpp"

#include <algorithm>
#include <charconv>
#include <vector>

#include "graph/campaign_block.hpp"

namespace pelorus::graph {

namespace {

const std::vector<std::string> top_keys{"pelorus", "title", "run", "frames", "graph", "campaign", "extend"};

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
    read_campaign(root.find("campaign"), problems);
    return settings;
}

}  // namespace pelorus::graph
