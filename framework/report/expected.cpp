#include "report/expected.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <system_error>

#include "graph/problems.hpp"
#include "graph/units.hpp"
#include "graph/yaml.hpp"
#include "host/error.hpp"

namespace pelorus::report {

namespace {

using Json = nlohmann::ordered_json;
using graph::Problems;
using graph::Value;

const std::vector<std::string> kinds{"published", "reproduced", "limit"};

std::optional<double> number_of(const Value& value) {
    try {
        if (value.is_scalar() && !value.quoted) return graph::parse_number(value.scalar);
    } catch (const graph::UnitError&) {
        return std::nullopt;
    }
    return std::nullopt;
}

Json read_number(const Value& value, const std::string& label, Problems& problems) {
    const std::optional<double> number = number_of(value);
    if (!number) problems.add(value.where, label + ": expected a number in SI units, got " + value.described());
    return number ? Json(*number) : Json(nullptr);
}

/// A map of numbers under some of `keys`.
Json read_numbers(const Value& map, const std::vector<std::string>& keys, const std::string& label,
                  Problems& problems) {
    Json numbers = Json::object();
    if (!map.is_map()) {
        problems.add(map.where,
                     label + ": expected a map with some of " + graph::join(keys) + ", got " + map.described());
        return numbers;
    }
    graph::check_keys(map, keys, label + ": ", problems);
    for (const Value::Entry& entry : map.map)
        numbers[entry.key] = read_number(entry.value, label + "." + entry.key, problems);
    return numbers;
}

/// Values as summary.json has them: numbers in SI, truth values, words.
Json read_sweep(const Value& map, const std::string& label, Problems& problems) {
    Json sweep = Json::object();
    if (!map.is_map())
        problems.add(map.where, label + ": expected a map from addresses to values, got " + map.described());
    for (const Value::Entry& entry : map.map) {
        const std::optional<double> number = number_of(entry.value);
        if (number)
            sweep[entry.key] = *number;
        else if (entry.value.is_scalar() && !entry.value.quoted &&
                 (entry.value.scalar == "true" || entry.value.scalar == "false"))
            sweep[entry.key] = entry.value.scalar == "true";
        else if (entry.value.is_scalar())
            sweep[entry.key] = entry.value.scalar;
        else
            problems.add(entry.value.where,
                         label + "." + entry.key + ": expected a single value, got " + entry.value.described());
    }
    return sweep;
}

Json read_cell(const Value& cell, const std::string& label, Problems& problems) {
    Json read{{"variant", "default"}, {"sweep", Json::object()}, {"scalars", Json::object()}};
    if (!cell.is_map()) {
        problems.add(cell.where, label + ": expected a map with variant, sweep, scalars, got " + cell.described());
        return read;
    }
    graph::check_keys(cell, {"variant", "sweep", "scalars"}, label + ": ", problems);
    if (const Value* variant = cell.find("variant")) {
        if (!variant->is_scalar())
            problems.add(variant->where,
                         label + ".variant: expected the name of a variant, got " + variant->described());
        read["variant"] = variant->scalar;
    }
    if (const Value* sweep = cell.find("sweep")) read["sweep"] = read_sweep(*sweep, label + ".sweep", problems);
    const Value* scalars = cell.find("scalars");
    if (scalars == nullptr || !scalars->is_map() || scalars->map.empty()) {
        problems.add(scalars == nullptr ? cell.where : scalars->where,
                     label + ".scalars: expected a map from names of scalars to figures" +
                         (scalars == nullptr ? "" : ", got " + scalars->described()));
        return read;
    }
    for (const Value::Entry& entry : scalars->map)
        read["scalars"][entry.key] = read_numbers(entry.value, kinds, label + ".scalars." + entry.key, problems);
    return read;
}

Json read_document(const Value& root, Problems& problems) {
    Json read{{"config", ""}, {"band", Json::object()}, {"cells", Json::array()}};
    if (!root.is_map()) {
        problems.add(root.where, "expected a map with expected, config, band, cells, got " + root.described());
        return read;
    }
    graph::check_keys(root, {"expected", "config", "band", "cells"}, "", problems);
    const Value* version = root.find("expected");
    if (version == nullptr || !version->is_scalar() || version->scalar != "1")
        problems.add(version == nullptr ? root.where : version->where,
                     "expected: 1 is the version of this format that is known here" +
                         (version == nullptr ? ", and it is missing" : ", got " + version->described()));
    if (const Value* config = root.find("config")) {
        if (!config->is_scalar())
            problems.add(config->where, "config: expected the name of a config file, got " + config->described());
        read["config"] = config->scalar;
    }
    if (const Value* band = root.find("band"))
        read["band"] = read_numbers(*band, {"published", "reproduced", "rounding"}, "band", problems);
    const Value* cells = root.find("cells");
    if (cells == nullptr || !cells->is_list()) {
        problems.add(cells == nullptr ? root.where : cells->where,
                     "cells: expected a list of maps with variant, sweep, scalars" +
                         (cells == nullptr ? std::string(", and it is missing") : ", got " + cells->described()));
        return read;
    }
    for (std::size_t i = 0; i < cells->list.size(); ++i)
        read["cells"].push_back(read_cell(cells->list[i], "cells[" + std::to_string(i) + "]", problems));
    return read;
}

}  // namespace

std::filesystem::path expected_file_of(const std::filesystem::path& config) {
    return config.parent_path() / (config.stem().string() + ".expected.yaml");
}

std::optional<Expected> read_expected(const std::filesystem::path& file) {
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return std::nullopt;
    std::ifstream stream(file, std::ios::binary);
    Expected expected{std::string{std::istreambuf_iterator<char>(stream), {}}, {}};
    if (!stream) throw Error(Exit::misuse, "cannot read " + file.string());
    Problems problems;
    expected.figures =
        read_document(graph::read_yaml(expected.text, {Location(), file.string(), file.parent_path()}), problems);
    problems.raise();
    return expected;
}

}  // namespace pelorus::report
