#include "report/result.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

#include "host/error.hpp"

namespace pelorus::report {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What is wrong with the form of summary.json.
class Form {
public:
    explicit Form(fs::path file) : file_(std::move(file)) {}

    void check(const Json& summary) const {
        const Json& cells = member(summary, "", "cells", "a list", &Json::is_array);
        for (std::size_t i = 0; i < cells.size(); ++i) check_cell(cells[i], "cells[" + std::to_string(i) + "]");
    }

private:
    using Is = bool (Json::*)() const noexcept;

    [[noreturn]] void fail(const std::string& place, const std::string& wanted) const {
        throw Error(Exit::run_failed, file_.string() + ": " + (place.empty() ? "the document" : place) + ": expected " +
                                          wanted + "; the file is not as `pelorus run` writes it");
    }
    const Json& member(const Json& of, const std::string& place, const std::string& name, const char* wanted,
                       Is is) const {
        if (!of.is_object()) fail(place, "an object");
        const std::string inner = place.empty() ? name : place + "." + name;
        const auto found = of.find(name);
        if (found == of.end() || !((*found).*is)()) fail(inner, wanted);
        return *found;
    }
    void check_number(const Json& of, const std::string& place, const std::string& name) const {
        const auto found = of.find(name);
        if (found == of.end() || !(found->is_number() || found->is_null()))
            fail(place + "." + name, "a number or null");
    }
    void check_cell(const Json& cell, const std::string& place) const {
        member(cell, place, "variant", "a text", &Json::is_string);
        member(cell, place, "sweep", "an object", &Json::is_object);
        member(cell, place, "runs", "a whole number", &Json::is_number_unsigned);
        for (const auto& [name, scalar] : member(cell, place, "scalars", "an object", &Json::is_object).items()) {
            const std::string inner = place + ".scalars." + name;
            member(scalar, inner, "unit", "a text", &Json::is_string);
            check_number(scalar, inner, "value");
            check_number(scalar, inner, "ci95");
        }
        for (const auto& [name, table] : member(cell, place, "tables", "an object", &Json::is_object).items())
            check_table(table, place + ".tables." + name);
    }
    void check_table(const Json& table, const std::string& place) const {
        const Json& columns = member(table, place, "columns", "a list", &Json::is_array);
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const std::string inner = fmt::format("{}.columns[{}]", place, i);
            member(columns[i], inner, "name", "a text", &Json::is_string);
            member(columns[i], inner, "unit", "a text", &Json::is_string);
        }
        const Json& rows = member(table, place, "rows", "a list", &Json::is_array);
        for (std::size_t i = 0; i < rows.size(); ++i)
            if (!rows[i].is_array() || rows[i].size() != columns.size())
                fail(fmt::format("{}.rows[{}]", place, i), fmt::format("a list of {} elements", columns.size()));
    }

    fs::path file_;
};

}  // namespace

Json read_json(const fs::path& file) {
    std::error_code ignored;
    if (!fs::exists(file, ignored)) return nullptr;
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) throw Error(Exit::run_failed, "cannot read " + file.string());
    try {
        return Json::parse(text);
    } catch (const Json::parse_error& problem) {
        const std::size_t at = std::min(problem.byte == 0 ? 0 : problem.byte - 1, text.size());
        const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
        const std::size_t begin = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
        throw Error(Exit::run_failed,
                    fmt::format("{}:{}:{}: this is not JSON; the file is damaged: run the config again", file.string(),
                                line, begin == std::string::npos ? at + 1 : at - begin));
    }
}

std::string Result::title() const {
    const std::string title =
        provenance.is_object() && provenance.contains("title") && provenance.at("title").is_string()
            ? provenance.at("title").get<std::string>()
            : "";
    return title.empty() ? fs::absolute(folder).lexically_normal().filename().string() : title;
}

Result read_result(const fs::path& folder) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored))
        throw Error(
            Exit::misuse,
            folder.string() + " is no folder; expected a result folder, as `pelorus run CONFIG --out DIR` writes it");
    const fs::path file = folder / "summary.json";
    if (!fs::exists(file, ignored))
        throw Error(
            Exit::misuse,
            folder.string() +
                " holds no summary.json; expected a result folder, as `pelorus run CONFIG --out DIR` writes it");
    Result result;
    result.folder = folder;
    result.summary = read_json(file);
    Form(file).check(result.summary);
    for (const auto& [name, into] :
         {std::pair<const char*, Json*>{"provenance.json", &result.provenance}, {"timing.json", &result.timing}}) {
        *into = read_json(folder / name);
        if (!into->is_object() && !into->is_null())
            throw Error(Exit::run_failed,
                        (folder / name).string() + ": expected an object; the file is not as `pelorus run` writes it");
    }
    result.expected = read_expected(folder / expected_file_name);
    return result;
}

bool have_same_runs(const Result& a, const Result& b) {
    if (!a.provenance.is_object() || !b.provenance.is_object()) return false;
    for (const char* name : {"seed", "runs"}) {
        const auto mine = a.provenance.find(name), theirs = b.provenance.find(name);
        if (mine == a.provenance.end() || theirs == b.provenance.end() || *mine != *theirs) return false;
    }
    return a.provenance.value("run", Json(0)) == b.provenance.value("run", Json(0));
}

}  // namespace pelorus::report
