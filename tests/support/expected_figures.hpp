// Campaigns as they are shipped, and the figures that stand beside their configs.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "../fixtures/temporary_folder.hpp"
#include "process.hpp"

namespace pelorus::test {

using Json = nlohmann::json;

/// The cells of configs/NAME.yaml, run as a campaign.
inline Json cells_of(const std::string& name, const std::vector<std::string>& flags) {
    const TemporaryFolder folder;
    std::vector<std::string> words{"run", PELORUS_SOURCE_DIR "/configs/" + name + ".yaml", "--out", folder / "out"};
    words.insert(words.end(), flags.begin(), flags.end());
    const Ended ended = pelorus_command(words);
    CAPTURE(ended.err);
    REQUIRE(ended.exit == 0);
    return Json::parse(folder.read("out/summary.json"))["cells"];
}

/// The cell of a variant at a grid point; `sweep` may name more addresses than the cell has.
inline const Json& cell_of(const Json& cells, const std::string& variant, const Json& sweep = Json::object()) {
    for (const Json& cell : cells) {
        bool meant = cell["variant"] == variant;
        for (const auto& [address, value] : cell["sweep"].items())  // 1 and 1.0 are equal
            meant = meant && (!sweep.contains(address) || sweep[address] == value);
        if (meant) return cell;
    }
    throw std::runtime_error("no cell of " + variant);
}

inline double value(const Json& cell, const std::string& scalar) { return cell["scalars"][scalar]["value"]; }

/// How far from what was reproduced a figure may lie.
struct Band {
    double relative, rounding;  ///< rounding: half of the last digit printed
};

/// One figure of NAME.expected.yaml beside ours.
inline void check_figure(double made, const YAML::Node& expected, const Band& band) {
    if (expected["reproduced"]) {
        const auto reproduced = expected["reproduced"].as<double>();
        CAPTURE(made, reproduced);
        CHECK(std::fabs(made - reproduced) <= band.relative * reproduced + band.rounding);
    }
    if (expected["limit"]) {
        const auto limit = expected["limit"].as<double>();
        CAPTURE(made, limit);
        CHECK(made <= limit);
    }
}

/// A number or a word.
inline Json sweep_value(const YAML::Node& node) {
    double number = 0;
    return YAML::convert<double>::decode(node, number) ? Json(number) : Json(node.as<std::string>());
}

/// All figures of NAME.expected.yaml, each within band_of(variant, scalar); answers how many.
template <class BandOf> std::size_t check_figures(const std::string& name, const Json& cells, BandOf band_of) {
    std::size_t figures = 0;
    for (const YAML::Node& entry : YAML::LoadFile(PELORUS_SOURCE_DIR "/configs/" + name + ".expected.yaml")["cells"]) {
        Json sweep = Json::object();
        if (entry["sweep"])
            for (const auto& axis : entry["sweep"]) sweep[axis.first.as<std::string>()] = sweep_value(axis.second);
        const auto variant = entry["variant"].as<std::string>();
        const Json& cell = cell_of(cells, variant, sweep);
        for (const auto& scalar : entry["scalars"]) {
            const auto scalar_name = scalar.first.as<std::string>();
            INFO(name << ", " << variant << ", " << sweep << ": " << scalar_name);
            check_figure(value(cell, scalar_name), scalar.second, band_of(variant, scalar_name));
            ++figures;
        }
    }
    return figures;
}

}  // namespace pelorus::test
