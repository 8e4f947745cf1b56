#include "report/comparison.hpp"

#include <cmath>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "report/text_table.hpp"

namespace pelorus::report {

namespace {

using Json = nlohmann::ordered_json;

std::set<std::string> variants_of(const Json& cells) {
    std::set<std::string> names;
    for (const Json& cell : cells) names.insert(cell.at("variant").get<std::string>());
    return names;
}

/// A name, and where on the grid the cell is.
std::string point_text(std::string text, const Json& cell) {
    for (const auto& [address, value] : cell.at("sweep").items())
        text += fmt::format(", {} = {}", address, value.dump());
    return text;
}

std::string cell_text(const Json& cell) { return point_text(cell.at("variant").get<std::string>(), cell); }

/// The interval of a difference of independent estimates.
Json independent_ci95(const Json& a, const Json& b) {
    if (!a.is_number() || !b.is_number()) return nullptr;
    return std::hypot(a.get<double>(), b.get<double>());
}

/// The scalars that two cells have in common; all others go to the lists.
Json scalars_of(const Json& a, const Json& b, const Json& paired, Json& only_a, Json& only_b) {
    Json told = Json::object();
    for (const auto& [name, mine] : a.at("scalars").items()) {
        const auto theirs = b.at("scalars").find(name);
        if (theirs == b.at("scalars").end() || theirs->at("unit") != mine.at("unit")) {
            only_a.push_back(cell_text(a) + ": " + name +
                             (theirs == b.at("scalars").end() ? "" : " in " + mine.at("unit").get<std::string>()));
            continue;
        }
        Json& entry = told[name];
        entry = {{"unit", mine.at("unit")},
                 {"a", mine.at("value")},
                 {"b", theirs->at("value")},
                 {"difference", nullptr},
                 {"ci95", nullptr}};
        if (!mine.at("value").is_number() || !theirs->at("value").is_number()) continue;
        entry["difference"] = theirs->at("value").get<double>() - mine.at("value").get<double>();
        entry["ci95"] = paired.is_object() && paired.contains(name)
                            ? paired.at(name).at("ci95")
                            : independent_ci95(mine.at("ci95"), theirs->at("ci95"));
    }
    for (const auto& [name, scalar] : b.at("scalars").items())
        if (!told.contains(name))
            only_b.push_back(cell_text(b) + ": " + name +
                             (a.at("scalars").contains(name) ? " in " + scalar.at("unit").get<std::string>() : ""));
    return told;
}

/// The cell of B that belongs to a cell of A, or one behind the last.
std::size_t partner(const Json& cell, const Json& others, bool whatever_variant) {
    for (std::size_t i = 0; i < others.size(); ++i)
        if (others[i].at("sweep") == cell.at("sweep") &&
            (whatever_variant || others[i].at("variant") == cell.at("variant")))
            return i;
    return others.size();
}

std::string number(const Json& value, const char* otherwise) {
    return value.is_number() ? fmt::format("{:.5g}", value.get<double>()) : otherwise;
}

bool is_clear(const Json& entry) {
    return entry.at("difference").is_number() && entry.at("ci95").is_number() &&
           std::abs(entry.at("difference").get<double>()) > entry.at("ci95").get<double>();
}

std::string cell_table(const Json& cell) {
    std::string heading = cell.at("variant_a").get<std::string>();
    if (cell.at("variant_b") != cell.at("variant_a")) heading += " -> " + cell.at("variant_b").get<std::string>();
    std::vector<Words> rows{{"", "A", "B", "B - A", "+-", ""}};
    for (const auto& [name, entry] : cell.at("scalars").items()) {
        const std::string unit = entry.at("unit").get<std::string>();
        rows.push_back({name + (unit.empty() ? "" : " [" + unit + "]"), number(entry.at("a"), "-"),
                        number(entry.at("b"), "-"), number(entry.at("difference"), "-"), number(entry.at("ci95"), "-"),
                        is_clear(entry) ? "*" : ""});
    }
    return point_text(std::move(heading), cell) + '\n' + joined(aligned_lines(rows)) + '\n';
}

std::string list_text(const std::string& title, const Json& names) {
    if (names.empty()) return "";
    constexpr std::size_t most_told = 20;
    std::string text = title + '\n';
    for (std::size_t i = 0; i < names.size() && i < most_told; ++i) text += "  " + names[i].get<std::string>() + '\n';
    if (names.size() > most_told) text += fmt::format("  and {} more, see --json\n", names.size() - most_told);
    return text + '\n';
}

}  // namespace

Json compare(const Result& a, const Result& b, const PairedCells& paired) {
    const Json &mine = a.summary.at("cells"), &theirs = b.summary.at("cells");
    const bool whatever_variant = variants_of(mine).size() == 1 && variants_of(theirs).size() == 1;
    const bool is_paired = have_same_runs(a, b);
    Json told{{"a", a.folder.string()}, {"b", b.folder.string()},  {"paired", is_paired},
              {"cells", Json::array()}, {"only_a", Json::array()}, {"only_b", Json::array()}};
    std::set<std::size_t> found;
    for (std::size_t i = 0; i < mine.size(); ++i) {
        const std::size_t j = partner(mine[i], theirs, whatever_variant);
        if (j == theirs.size()) {
            told["only_a"].push_back(cell_text(mine[i]));
            continue;
        }
        found.insert(j);
        const Json differences = is_paired ? paired(i, j) : Json(nullptr);
        told["cells"].push_back(
            {{"variant_a", mine[i].at("variant")},
             {"variant_b", theirs[j].at("variant")},
             {"sweep", mine[i].at("sweep")},
             {"scalars", scalars_of(mine[i], theirs[j], differences, told["only_a"], told["only_b"])}});
    }
    for (std::size_t j = 0; j < theirs.size(); ++j)
        if (found.count(j) == 0) told["only_b"].push_back(cell_text(theirs[j]));
    return told;
}

std::string comparison_table(const Json& comparison) {
    std::string text = fmt::format(
        "A: {}\nB: {}\n{}\n\n", comparison.at("a").get<std::string>(), comparison.at("b").get<std::string>(),
        comparison.at("paired") == true ? "same seed and runs: differences are taken run by run"
                                        : "other seed or runs: intervals are those of independent runs");
    for (const Json& cell : comparison.at("cells")) text += cell_table(cell);
    if (comparison.at("cells").empty()) text += "no cell in common\n\n";
    return text + list_text("only in A", comparison.at("only_a")) + list_text("only in B", comparison.at("only_b"));
}

}  // namespace pelorus::report
