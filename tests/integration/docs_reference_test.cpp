// The documentation as a whole: its links lead somewhere, its index and the generated references are complete, and the plugins'
// pages agree with what the plugins say of themselves.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>

#include "../support/markdown.hpp"
#include "../support/process.hpp"
#include "docs_page.hpp"

using namespace pelorus::test;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

const fs::path tree = PELORUS_SOURCE_DIR;
const fs::path generated = fs::path(PELORUS_BUILD_DIR) / "share" / "doc" / "pelorus";

/// Every Markdown file below a folder, but for what is built or hidden.
std::vector<fs::path> markdown_files(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (name == "build" || name == "results" || name.front() == '.') continue;
        if (entry.is_directory()) {
            const std::vector<fs::path> below = markdown_files(entry.path());
            files.insert(files.end(), below.begin(), below.end());
        } else if (entry.path().extension() == ".md") {
            files.push_back(entry.path());
        }
    }
    return files;
}

/// What is wrong with a link, or "".
std::string fault_of(const Link& link, const fs::path& page) {
    if (std::regex_search(link.target, std::regex("^[a-z]+:"))) return "";  // another site, or mail
    const std::size_t hash = link.target.find('#');
    const std::string file = link.target.substr(0, hash);
    const fs::path target = file.empty() ? page : page.parent_path() / file;
    if (!fs::exists(target)) return "there is no " + target.lexically_normal().string();
    if (hash == std::string::npos || target.extension() != ".md") return "";
    const std::string anchor = link.target.substr(hash + 1);
    return read_markdown(target).anchors.count(anchor) != 0 ? "" : "no heading makes the anchor #" + anchor;
}

std::vector<std::string> dead_links(const fs::path& folder) {
    std::vector<std::string> dead;
    for (const fs::path& page : markdown_files(folder))
        for (const Link& link : read_markdown(page).links)
            if (const std::string fault = fault_of(link, page); !fault.empty())
                dead.push_back(fs::relative(page, folder).string() + ":" + std::to_string(link.line) + ": " +
                               link.target + ": " + fault);
    return dead;
}

Json answer(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const Ended ended = shipped_command(std::move(arguments));
    REQUIRE(ended.exit == 0);
    return Json::parse(ended.out);
}

Json parameters_of(const std::string& id) { return answer({"inspect", id})["parameters"]; }

/// The texts between backticks.
std::vector<std::string> quoted(const std::string& cell) {
    static const std::regex form("`([^`]*)`");
    std::vector<std::string> names;
    for (std::sregex_iterator name(cell.begin(), cell.end(), form), end; name != end; ++name)
        names.push_back((*name)[1]);
    return names;
}

/// The numbers of a text; digits of a unit are none.
std::vector<double> numbers(const std::string& text) {
    static const std::regex form("(^|[^A-Za-z0-9.^])([-+]?[0-9]+(\\.[0-9]+)?(e[-+]?[0-9]+)?)");
    std::vector<double> values;
    const std::string bare = std::regex_replace(text, std::regex("1/[A-Za-z]"), "");
    for (std::sregex_iterator value(bare.begin(), bare.end(), form), end; value != end; ++value)
        values.push_back(std::stod((*value)[2]));
    return values;
}

/// The default of the description, or what its text says to hold "if absent"; null if neither.
Json default_of(const Json& parameter) {
    if (!parameter["default"].is_null()) return parameter["default"];
    static const std::regex form("([0-9][^ ;,]*( [^ ;,]+)?) if absent");
    const auto doc = parameter["doc"].get<std::string>();
    std::smatch match;
    return std::regex_search(doc, match, form) ? Json(match[1].str()) : Json(nullptr);
}

/// Whether a page's words for a default mean that of the description (null: there is none). Units may stand in another column.
bool same_default(std::string told, const Json& described) {
    told.erase(std::remove(told.begin(), told.end(), '`'), told.end());
    if (described.is_null() || described == "''" || described == "[]") return numbers(told).empty();
    auto text = described.get<std::string>();
    // A vector of one element is told as that.
    if (text.front() == '[' && text.find(',') == std::string::npos) text = text.substr(1, text.size() - 2);
    if (told == text) return true;
    const bool has_unit = std::regex_search(told, std::regex("[A-Za-z]"));
    return !numbers(text).empty() && !has_unit && numbers(told) == numbers(text);
}

/// What a page's tables of parameters tell: the cell of the default by the parameter's name.
std::map<std::string, std::string> told_parameters(const fs::path& page) {
    std::map<std::string, std::string> told;
    for (const Table& table : read_markdown(page).tables) {
        if (table.empty() || table[0].empty() || table[0][0] != "parameter") continue;
        const auto column = std::find(table[0].begin(), table[0].end(), "default") - table[0].begin();
        for (std::size_t row = 1; row < table.size(); ++row) {
            const std::vector<std::string> names = quoted(table[row][0]);
            const std::string& all = table[row].at(static_cast<std::size_t>(column));
            for (std::size_t i = 0; i < names.size(); ++i) {
                // `birth`, `death` | 0, never: one each, in the same order
                std::string cell = all;
                if (names.size() > 1 && count(all, ", ") == names.size() - 1) {
                    for (std::size_t skipped = 0; skipped < i; ++skipped) cell.erase(0, cell.find(", ") + 2);
                    cell = cell.substr(0, cell.find(", "));
                }
                told[names[i]] = cell;
            }
        }
    }
    return told;
}

}  // namespace

TEST_CASE("no link of the documentation is dead", "[release-only]") {
    for (const std::string& dead : dead_links(tree)) UNSCOPED_INFO(dead);
    CHECK(dead_links(tree).empty());
    for (const std::string& dead : dead_links(generated)) UNSCOPED_INFO(dead);
    CHECK(dead_links(generated).empty());
}

TEST_CASE("a dead link is found, whether the file or the heading is missing") {
    const fs::path page = tree / "docs" / "README.md";
    CHECK(fault_of({1, "config.md#units"}, page).empty());
    CHECK(fault_of({1, "#the-documentation-in-reading-order"}, page).empty());
    CHECK(fault_of({1, "https://example.org/"}, page).empty());
    CHECK_THAT(fault_of({1, "nowhere.md"}, page), Catch::Contains("there is no"));
    CHECK_THAT(fault_of({1, "config.md#nowhere"}, page), Catch::Contains("#nowhere"));
}

TEST_CASE("the index of the documentation leads to every page") {
    std::set<std::string> listed = {"README.md"};
    for (const Link& link : read_markdown(tree / "docs" / "README.md").links) listed.insert(link.target);
    for (const fs::directory_entry& entry : fs::directory_iterator(tree / "docs")) {
        const std::string name = entry.path().filename().string();
        CAPTURE(name);
        if (entry.path().extension() == ".md") CHECK(listed.count(name) == 1);
    }
}

TEST_CASE("every plugin and every header has its page in the generated references", "[release-only]") {
    for (const Json& plugin : answer({"list"})) {
        const auto id = plugin["id"].get<std::string>();
        CAPTURE(id);
        const fs::path page = generated / "reference" / (id + ".md");
        REQUIRE(fs::exists(page));
        const std::string text = read_file(page);
        for (const Json& parameter : parameters_of(id))
            CHECK_THAT(text, Catch::Contains("| `" + parameter["name"].get<std::string>() + "` |"));
        CHECK_THAT(read_file(generated / "reference" / "README.md"), Catch::Contains("(" + id + ".md)"));
    }
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(tree / "sdk" / "include")) {
        std::string extension = entry.path().extension().string();
        if (extension != ".h" && extension != ".hpp") continue;
        CAPTURE(entry.path());
        const std::string stem = std::regex_replace(entry.path().stem().string(), std::regex("_"), "__");
        CHECK(fs::exists(generated / "headers" / (stem + "_8" + extension.substr(1) + ".html")));
    }
}

TEST_CASE("every check of the conformance suites is in the generated list, with its law", "[release-only]") {
    const std::string text = read_file(generated / "conformance.md");
    const Json checks = Json::parse(pelorus_command({"conform", "--list", "--json=-"}).out);
    REQUIRE(checks.size() >= 70);
    for (const Json& check : checks) {
        CHECK_THAT(text, Catch::Contains("| `" + check["name"].get<std::string>() + "` |"));
        const std::string law = std::regex_replace(check["law"].get<std::string>(), std::regex("\\|"), "\\|");
        CHECK_THAT(text, Catch::Contains(law));
    }
}

TEST_CASE("the tables of parameters in the plugins' pages agree with the plugins", "[release-only]") {
    for (const Json& listed : answer({"list"})) {
        const auto id = listed["id"].get<std::string>();
        const std::string folder = std::regex_replace(id, std::regex("\\."), "/");
        CAPTURE(id);
        const fs::path page = tree / "plugins" / folder / "README.md";
        REQUIRE(fs::exists(page));
        CHECK(trimmed(read_file(page).substr(0, read_file(page).find('\n'))) == "# " + id);
        std::map<std::string, std::string> told = told_parameters(page);
        for (const Json& parameter : parameters_of(id)) {
            const auto name = parameter["name"].get<std::string>();
            const auto entry = told.find(name);
            CAPTURE(name, parameter["default"]);
            if (entry == told.end()) {
                FAIL_CHECK("the page does not tell this parameter");
                continue;
            }
            CAPTURE(entry->second);
            CHECK(same_default(entry->second, default_of(parameter)));
            told.erase(entry);
        }
        for (const auto& [name, value] : told) FAIL_CHECK(id << " has no parameter " << name);
    }
}

TEST_CASE("defaults are compared by what they mean") {
    CHECK(same_default("`1000 km`", "1000 km"));
    CHECK(same_default("100", "100 m/s"));
    CHECK(same_default("[5, 1, 0.5]", "[5 m, 1 m/s, 0.5 m/s2]"));
    CHECK(same_default("0.1", "0.1 1/s"));
    CHECK(same_default("1 mrad", "[1 mrad]"));
    CHECK(same_default("none", nullptr));
    CHECK(default_of({{"default", nullptr}, {"doc", "of the jerk; form continuous only, there 1 m2/s5 if absent"}}) ==
          "1 m2/s5");
    CHECK(default_of({{"default", nullptr}, {"doc", "absent: never"}}).is_null());
    CHECK(same_default("all rows", "[]"));
    CHECK_FALSE(same_default("100", "10 m/s"));
    CHECK_FALSE(same_default("100 km", "100 m"));
    CHECK_FALSE(same_default("3", nullptr));
    CHECK_FALSE(same_default("exact", "truncated"));
    CHECK_FALSE(same_default("", "1 s"));
}
