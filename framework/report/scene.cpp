#include "report/scene.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "host/error.hpp"
#include "report/lineage.hpp"
#include "report/terminal_table.hpp"

namespace pelorus::report {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

constexpr std::size_t most_entries = 20000;

/// The fields of a line. Quotes are taken off; names and lists of ids hold no line ends.
Words fields_of(const std::string& line) {
    Words fields(1);
    bool is_quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"')
            fields.back() += line[i++];
        else if (line[i] == '"')
            is_quoted = !is_quoted;
        else if (line[i] == ',' && !is_quoted)
            fields.emplace_back();
        else if (line[i] != '\r')
            fields.back() += line[i];
    }
    return fields;
}

int column_of(const Words& header, const std::string& name) {
    const auto found = std::find(header.begin(), header.end(), name);
    return found == header.end() ? -1 : static_cast<int>(found - header.begin());
}

std::string kind_of(const Words& header) {
    if (column_of(header, "time") < 0 || column_of(header, "id") < 0) return "";
    for (const auto& [column, kind] :
         {std::pair<const char*, const char*>{"status", "tracks"}, {"parent", "truth"}, {"snr", "scans"}})
        if (column_of(header, column) >= 0) return kind;
    return "";
}

std::vector<int> columns_of(const Words& header, const Words& names) {
    std::vector<int> columns;
    for (const std::string& name : names)
        if (const int column = column_of(header, name); column >= 0) columns.push_back(column);
    return columns;
}

struct Entry {
    double time = 0;
    std::string id;
    std::vector<double> position, extent;
    std::string parents, group;  ///< of tracks
};

class Table {
public:
    Table(fs::path file, const Words& header)
        : file_(std::move(file)),
          width_(header.size()),
          time_(column_of(header, "time")),
          id_(column_of(header, "id")),
          parents_(column_of(header, "parents")),
          group_(column_of(header, "group")),
          position_(columns_of(header, {"position.x", "position.y", "position.z"})),
          extent_(columns_of(header, {"extent.xx", "extent.xy", "extent.xz", "extent.yy", "extent.yz", "extent.zz"})) {}

    bool is_drawable() const { return position_.size() >= 2; }
    bool has_extent() const { return extent_.size() == 3 || extent_.size() == 6; }
    std::size_t axes() const { return position_.size(); }

    Entry entry(const std::string& line, std::size_t number) const {
        const Words fields = fields_of(line);
        if (fields.size() != width_)
            throw Error(Exit::run_failed, fmt::format("{}:{}: expected {} fields, got {}; the file is damaged",
                                                      file_.string(), number, width_, fields.size()));
        const auto read = [&](int column) { return number_of(fields[static_cast<std::size_t>(column)], number); };
        const auto text = [&](int column) { return column < 0 ? "" : fields[static_cast<std::size_t>(column)]; };
        Entry entry{read(time_), text(id_), {}, {}, text(parents_), text(group_)};
        for (const int column : position_) entry.position.push_back(read(column));
        if (has_extent())
            for (const int column : extent_) entry.extent.push_back(read(column));
        return entry;
    }

private:
    /// An empty field is no number.
    double number_of(const std::string& field, std::size_t line) const {
        double number = std::numeric_limits<double>::quiet_NaN();
        const auto [end, problem] = std::from_chars(field.data(), field.data() + field.size(), number);
        if (!field.empty() && (problem == std::errc::invalid_argument || end != field.data() + field.size()))
            throw Error(Exit::run_failed, fmt::format("{}:{}: expected a number, got '{}'; the file is damaged",
                                                      file_.string(), line, field));
        return number;
    }

    fs::path file_;
    std::size_t width_;
    int time_, id_, parents_, group_;
    std::vector<int> position_, extent_;
};

/// Nine digits: a millimetre in a thousand kilometres.
Json rounded(double x) {
    if (!std::isfinite(x)) return nullptr;
    const std::string text = fmt::format("{:.9g}", x);
    double number = 0;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
}

std::set<double> kept_times(const std::set<double>& times, std::size_t every) {
    std::set<double> kept;
    std::size_t index = 0;
    for (const double time : times)
        if (index++ % every == 0) kept.insert(time);
    return kept;
}

Json lineage_of(const std::string& kind, const std::vector<Entry>& entries) {
    if (kind != "tracks") return nullptr;
    std::vector<Sighting> sightings;
    for (const Entry& entry : entries) sightings.push_back({entry.time, entry.id, entry.parents});
    std::stable_sort(sightings.begin(), sightings.end(),
                     [](const Sighting& a, const Sighting& b) { return a.time < b.time; });
    return lineage_json(sightings);
}

/// Tables of tracks to which another one's column `group` leads are tables of groups.
void find_groups(Json& scene, const std::vector<std::set<std::string>>& ids,
                 const std::vector<std::set<std::string>>& groups) {
    for (std::size_t i = 0; i < scene.size(); ++i)
        for (std::size_t j = 0; j < scene.size(); ++j)
            if (i != j && scene[i]["kind"] == "tracks" && !groups[j].empty() &&
                std::includes(ids[i].begin(), ids[i].end(), groups[j].begin(), groups[j].end()))
                scene[i]["kind"] = "groups";
}

Json table_json(const fs::path& file, const std::string& kind, const Table& table, const std::vector<Entry>& entries) {
    std::set<double> times;
    for (const Entry& entry : entries) times.insert(entry.time);
    const std::size_t every = std::max<std::size_t>(1, (entries.size() + most_entries - 1) / most_entries);
    const std::set<double> kept = kept_times(times, every);
    Json told{{"name", file.filename().string()},
              {"kind", kind},
              {"times", times.size()},
              {"every", every},
              {"time", Json::array()},
              {"id", Json::array()},
              {"position", Json(table.axes(), Json::array())},
              {"extent", nullptr},
              {"lineage", lineage_of(kind, entries)}};
    if (table.has_extent()) told["extent"] = Json::array();
    for (const Entry& entry : entries) {
        if (kept.count(entry.time) == 0 ||
            !std::all_of(entry.position.begin(), entry.position.end(), [](double x) { return std::isfinite(x); }))
            continue;
        told["time"].push_back(entry.time);
        told["id"].push_back(entry.id);
        for (std::size_t a = 0; a < entry.position.size(); ++a)
            told["position"][a].push_back(rounded(entry.position[a]));
        for (std::size_t k = 0; k < entry.extent.size(); ++k) told["extent"][k].push_back(rounded(entry.extent[k]));
    }
    return told;
}

}  // namespace

Json read_scene(const fs::path& folder) {
    Json scene = Json::array();
    std::vector<std::set<std::string>> ids, groups;  // of each table
    for (const std::string& name : file_names(folder)) {
        if (fs::path(name).extension() != ".csv") continue;
        const fs::path file = folder / name;
        std::ifstream stream(file, std::ios::binary);
        std::string line;
        if (!std::getline(stream, line)) continue;
        const Words header = fields_of(line);
        const std::string kind = kind_of(header);
        const Table table(file, header);
        if (kind.empty() || !table.is_drawable()) continue;
        std::vector<Entry> entries;
        for (std::size_t number = 2; std::getline(stream, line); ++number) {
            Entry entry = table.entry(line, number);
            if (std::isfinite(entry.time)) entries.push_back(std::move(entry));
        }
        scene.push_back(table_json(file, kind, table, entries));
        ids.emplace_back();
        groups.emplace_back();
        for (const Entry& entry : entries) {
            ids.back().insert(entry.id);
            if (!entry.group.empty()) groups.back().insert(entry.group);
        }
    }
    find_groups(scene, ids, groups);
    return scene;
}

}  // namespace pelorus::report
