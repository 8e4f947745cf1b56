#include "report/page.hpp"

#include <fstream>
#include <iterator>
#include <map>

#include <fmt/format.h>

#include "host/error.hpp"
#include "report/scene.hpp"

namespace pelorus::report {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string read_part(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream)
        throw Error(Exit::run_failed,
                    "cannot read " + file.string() + ", a part of the page; is this a complete installation?");
    return text;
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

/// A program within <script>: what would end the element, or begin a comment, says the same in another way.
std::string as_script(std::string text) {
    replace_all(text, "</script", "<\\/script");
    replace_all(text, "<!--", "<\\!--");
    return text;
}

std::string as_text(std::string text) {
    replace_all(text, "&", "&amp;");
    replace_all(text, "<", "&lt;");
    replace_all(text, ">", "&gt;");
    return text;
}

/// JSON in which no markup can begin: `<` stands in texts alone, and there it has an escape.
std::string as_block(const std::string& id, const Json& json) {
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    replace_all(text, "<", "\\u003c");
    return "<script type=\"application/json\" id=\"" + id + "\">" + text + "</script>\n";
}

/// Fills in `@WORD@`. What is filled in is not searched again.
std::string filled(const std::string& text, const std::map<std::string, std::string>& words) {
    std::string out;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t begin = text.find('@', at),
                          end = begin == std::string::npos ? begin : text.find('@', begin + 1);
        const auto word = end == std::string::npos ? words.end() : words.find(text.substr(begin + 1, end - begin - 1));
        if (word == words.end()) {
            const std::size_t next = begin == std::string::npos ? text.size() : begin + 1;
            out.append(text, at, next - at);
            at = next;
        } else {
            out.append(text, at, begin - at);
            out += word->second;
            at = end + 1;
        }
    }
    return out;
}

constexpr std::size_t most_rows = 2000;

Json thinned(Json summary) {
    for (Json& cell : summary["cells"])
        for (auto& item : cell["tables"].items()) {
            Json& table = item.value();
            const std::size_t count = table["rows"].size();
            if (count <= most_rows) continue;
            const std::size_t every = (count + most_rows - 2) / (most_rows - 1);
            Json rows = Json::array();
            for (std::size_t i = 0; i < count; ++i)
                if (i % every == 0 || i + 1 == count) rows.push_back(std::move(table["rows"][i]));
            table["rows"] = std::move(rows);
            table["shown_every"] = every;
            table["all_rows"] = count;
        }
    return summary;
}

std::string lead(const Result& result) {
    const std::string config =
        result.provenance.is_object() ? result.provenance.value("config_file", std::string()) : "";
    const std::size_t cells = result.summary.at("cells").size();
    return fmt::format("{}{} {}", config.empty() ? "" : config + " · ", cells, cells == 1 ? "cell" : "cells");
}

}  // namespace

Blocks report_blocks(const Result& result, const Json& samples) {
    Json notes = Json::array();
    if (result.timing.is_null()) notes.push_back("There is no timing.json in this folder.");
    const Json scene = read_scene(result.folder);
    if (scene.empty())
        notes.push_back(
            "No table of this folder tells positions in space (sink.csv writes tracks, truth and scans): there is no "
            "scene.");
    return {{"page",
             {{"kind", "report"},
              {"title", result.title()},
              {"lead", lead(result)},
              {"version", PELORUS_VERSION},
              {"notes", notes}}},
            {"summary", thinned(result.summary)},
            {"provenance", result.provenance},
            {"timing", result.timing},
            {"beside", result.expected ? beside_expected(result.summary, result.expected->figures) : Json(nullptr)},
            {"scene", scene},
            {"samples", samples}};
}

std::string html_page(const fs::path& parts, const std::string& title, const Blocks& blocks) {
    std::string data;
    for (const auto& [id, json] : blocks)
        if (!json.is_null()) data += as_block(id, json);
    return filled(read_part(parts / "index.html"), {{"TITLE", as_text(title)},
                                                    {"STYLE", read_part(parts / "style.css")},
                                                    {"DATA", data},
                                                    {"PLOTLY", as_script(read_part(parts / "plotly.js"))},
                                                    {"SCRIPTS", as_script(read_part(parts / "page.js"))}});
}

}  // namespace pelorus::report
