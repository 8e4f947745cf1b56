// Results beside the figures that were expected of them.
#include <cmath>

#include "report/expected.hpp"

namespace pelorus::report {

namespace {

using Json = nlohmann::ordered_json;

bool is_same_value(const Json& a, const Json& b) {
    if (!a.is_number() || !b.is_number()) return a == b;
    const double x = a.get<double>(), y = b.get<double>();
    return std::abs(x - y) <= 1e-9 * std::max(std::abs(x), std::abs(y));
}

bool is_same_sweep(const Json& a, const Json& b) {
    if (a.size() != b.size()) return false;
    for (const auto& [address, value] : a.items()) {
        const auto other = b.find(address);
        if (other == b.end() || !is_same_value(value, *other)) return false;
    }
    return true;
}

const Json* cell_of(const Json& summary, const Json& expected) {
    for (const Json& cell : summary.at("cells"))
        if (cell.at("variant") == expected.at("variant") && is_same_sweep(cell.at("sweep"), expected.at("sweep")))
            return &cell;
    return nullptr;
}

Json judged(const std::string& kind, double expected, const Json& value, const Json& bands) {
    Json told{{"kind", kind}, {"value", expected}, {"deviation", nullptr}, {"band", nullptr}, {"within", nullptr}};
    const bool is_limit = kind == "limit";
    if (const auto band = bands.find(kind); band != bands.end()) told["band"] = *band;
    if (!value.is_number()) {  // what has no value keeps to nothing
        if (is_limit || told["band"].is_number()) told["within"] = false;
        return told;
    }
    const double difference = value.get<double>() - expected, scale = std::abs(expected);
    if (scale > 0) told["deviation"] = difference / scale;
    if (is_limit)
        told["within"] = difference <= 0;
    else if (told["band"].is_number())
        told["within"] = std::abs(difference) <= told["band"].get<double>() * scale + bands.value("rounding", 0.0);
    return told;
}

}  // namespace

Json beside_expected(const Json& summary, const Json& figures) {
    Json told{{"figures", Json::array()}, {"judged", 0}, {"outside", 0}};
    std::size_t all = 0, outside = 0;
    for (const Json& expected : figures.at("cells")) {
        const Json* cell = cell_of(summary, expected);
        if (cell == nullptr) continue;
        for (const auto& [name, kinds] : expected.at("scalars").items()) {
            const auto scalar = cell->at("scalars").find(name);
            if (scalar == cell->at("scalars").end()) continue;
            const Json& value = scalar->at("value");
            Json figure{{"variant", cell->at("variant")},
                        {"sweep", cell->at("sweep")},
                        {"scalar", name},
                        {"unit", scalar->at("unit")},
                        {"value", value},
                        {"ci95", scalar->at("ci95")},
                        {"expected", Json::array()}};
            for (const auto& [kind, number] : kinds.items()) {
                figure["expected"].push_back(judged(kind, number.get<double>(), value, figures.at("band")));
                const Json& within = figure["expected"].back()["within"];
                if (within.is_boolean()) ++all;
                if (within == false) ++outside;
            }
            told["figures"].push_back(std::move(figure));
        }
    }
    told["judged"] = all;
    told["outside"] = outside;
    return told;
}

}  // namespace pelorus::report
