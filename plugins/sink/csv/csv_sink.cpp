#include "csv_sink.hpp"

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace sink_csv {

namespace {

const char* status_word(std::int32_t status) {
    switch (status) {
        case PLR_TRACK_TENTATIVE:
            return "tentative";
        case PLR_TRACK_CONFIRMED:
            return "confirmed";
        case PLR_TRACK_COASTING:
            return "coasting";
        default:
            return "deleted";
    }
}

std::string component_names(const plr_space& raw) {
    const pelorus::Space space(raw);
    std::string text;
    for (const auto& component : space.components()) text += "," + component.name;
    return text;
}

/// `,extent.xx,extent.xy,extent.yy`: the upper triangle, row by row.
std::string extent_names(const plr_const_view& extent) {
    std::string text;
    if (extent.data == nullptr) return text;
    for (std::int64_t r = 0; r < extent.rows; ++r)
        for (std::int64_t c = r; c < extent.cols; ++c) text += std::string(",extent.") + "xyz"[r] + "xyz"[c];
    return text;
}

void write_extent(Table& table, const plr_const_view& extent, std::int64_t i) {
    if (extent.data == nullptr) return;
    const auto matrix = pelorus::item(extent, i);
    for (std::int64_t r = 0; r < extent.rows; ++r)
        for (std::int64_t c = r; c < extent.cols; ++c) table.number(matrix(r, c));
}

void write_vector(Table& table, const plr_const_view& vectors, std::int64_t i) {
    for (std::int64_t r = 0; r < vectors.rows; ++r)
        table.number(vectors.data[i * vectors.item_stride + r * vectors.row_stride]);
}

/// List i of a ragged one, empty where there is none.
void write_list(Table& table, const std::int64_t* offsets, const std::uint64_t* ids, std::int64_t i) {
    if (offsets == nullptr)
        table.empty();
    else
        table.ids(ids, offsets[i], offsets[i + 1]);
}

}  // namespace

void Table::begin(const std::string& header) {
    if (file_.size() == 0) {
        header_ = header;
        file_.write(header + "\n");
    } else if (header != header_) {
        throw pelorus::DataError("the file has the columns " + header_ + ", this message has " + header);
    }
}

void Table::finish() {
    if (file_.size() == 0 && !header_.empty()) file_.write(header_ + "\n");
    file_.finish();
}

Table& Table::text(std::string_view value) {
    separate();
    if (value.find_first_of(",\"\r\n") == std::string_view::npos) return file_.write(value), *this;
    file_.write("\"");
    for (const char c : value) file_.write(c == '"' ? "\"\"" : std::string_view(&c, 1));
    file_.write("\"");
    return *this;
}

Table& Table::ids(const std::uint64_t* list, std::int64_t first, std::int64_t last) {
    separate();
    for (std::int64_t i = first; i < last; ++i) {
        if (i > first) file_.write(" ");
        file_.integer(list[i]);
    }
    return *this;
}

void CsvSink::describe(pelorus::Describe<CsvSink>& plugin) {
    plugin.title("Tables of text")
        .purpose(
            "Writes what it is given as CSV files of the result folder, one row an entry, SI units, times in seconds "
            "of "
            "the run, numbers with as many digits as it takes to read them back exactly. A file has its name once it "
            "is "
            "complete.")
        .source("Y. Shafranovich, Common Format and MIME Type for CSV Files, RFC 4180, 2005");
    plugin.parameter("tracks", &CsvSink::tracks_name_).initially("tracks.csv").doc("file of the tracks");
    plugin.parameter("truth", &CsvSink::truth_name_).initially("truth.csv").doc("file of the truth");
    plugin.parameter("scans", &CsvSink::scans_name_)
        .initially("scans.csv")
        .doc("files of the scans; each has its sensor's name before the suffix: scans_radar.csv");
    plugin.parameter("uncertainty", &CsvSink::uncertainty_)
        .initially("deviations")
        .choices({{"none", ""},
                  {"deviations", "the standard deviation of each component"},
                  {"covariance", "the upper triangle of the covariance, row by row"}})
        .doc("what is written of a track's uncertainty");
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "estimates", PLR_PORT_OPTIONAL);
    plugin.in_port("truth", PLR_MESSAGE_TRUTH, "what really was", PLR_PORT_OPTIONAL);
    plugin.in_port("scans", PLR_MESSAGE_SCAN, "measurements, of any sensors", PLR_PORT_OPTIONAL | PLR_PORT_MANY);
}

void CsvSink::setup(const pelorus::Setup& setup) {
    tracks_.setup(setup, "tracks", tracks_name_);
    truth_.setup(setup, "truth", truth_name_);
    pelorus::ResultFile().setup(setup, "scans", scans_name_);  // refuses what is no name
    if (tracks_name_ == truth_name_) throw pelorus::ParameterError("truth", "has the name of the tracks' file");
}

std::string CsvSink::tracks_header(const plr_tracks& message) const {
    std::string header = "time,id,status,misses" + component_names(*message.space);
    const pelorus::Space space(*message.space);
    const auto& components = space.components();
    for (std::size_t r = 0; r < components.size(); ++r) {
        if (uncertainty_ == Uncertainty::deviations) header += ",deviation." + components[r].name;
        if (uncertainty_ != Uncertainty::covariance) continue;
        for (std::size_t c = r; c < components.size(); ++c)
            header += ",covariance." + components[r].name + "." + components[c].name;
    }
    return header + extent_names(message.extent) + ",parents,group,measurements";
}

void CsvSink::on_tracks(const pelorus::Event&, const plr_tracks& message) {
    if (message.count == 0) return tracks_.expect(tracks_header(message));
    tracks_.begin(tracks_header(message));
    for (std::int64_t i = 0; i < message.count; ++i) {
        tracks_.seconds(message.times[i]).integer(message.ids[i]).text(status_word(message.status[i]));
        tracks_.integer(std::int64_t{message.misses[i]});
        write_vector(tracks_, message.mean, i);
        write_uncertainty(message.covariance, i);
        write_extent(tracks_, message.extent, i);
        write_list(tracks_, message.parent_offsets, message.parents, i);
        if (message.groups == nullptr || message.groups[i] == 0)
            tracks_.empty();
        else
            tracks_.integer(message.groups[i]);
        write_list(tracks_, message.measurement_offsets, message.measurements, i);
        tracks_.end_row();
    }
}

void CsvSink::write_uncertainty(const plr_const_view& covariance, std::int64_t i) {
    if (uncertainty_ == Uncertainty::none) return;
    const auto matrix = pelorus::item(covariance, i);
    for (std::int64_t r = 0; r < covariance.rows; ++r) {
        if (uncertainty_ == Uncertainty::deviations) tracks_.number(std::sqrt(matrix(r, r)));
        if (uncertainty_ != Uncertainty::covariance) continue;
        for (std::int64_t c = r; c < covariance.cols; ++c) tracks_.number(matrix(r, c));
    }
}

void CsvSink::on_truth(const pelorus::Event&, const plr_truth& message) {
    const std::string header =
        "time,id" + component_names(*message.space) + extent_names(message.extent) + ",parent,measurements";
    if (message.count == 0) return truth_.expect(header);
    truth_.begin(header);
    for (std::int64_t i = 0; i < message.count; ++i) {
        truth_.seconds(message.times[i]).integer(message.ids[i]);
        write_vector(truth_, message.state, i);
        write_extent(truth_, message.extent, i);
        if (message.parents == nullptr || message.parents[i] == message.ids[i])
            truth_.empty();
        else
            truth_.integer(message.parents[i]);
        write_list(truth_, message.measurement_offsets, message.measurements, i);
        truth_.end_row();
    }
}

/// The table of a sensor's scans: scans.csv becomes scans_radar.csv.
Table& CsvSink::scans_of(const std::string& sensor) {
    const auto [found, is_new] = scans_.try_emplace(sensor);
    if (is_new) {
        std::string word = sensor;
        for (char& c : word)
            if (std::string_view("/\\:").find(c) != std::string_view::npos || static_cast<unsigned char>(c) < ' ')
                c = '_';
        const std::filesystem::path name(scans_name_);
        found->second.setup(
            tracks_.file(), "scans",
            (name.parent_path() / (name.stem().string() + "_" + word + name.extension().string())).string());
    }
    return found->second;
}

void CsvSink::on_scan(const pelorus::Event& event, const plr_scan& message) {
    Table& table = scans_of(message.sensor);
    const std::string header = "time,id" + component_names(*message.space) + ",snr";
    if (message.measurements.count == 0) return table.expect(header);
    table.begin(header);
    for (std::int64_t i = 0; i < message.measurements.count; ++i) {
        table.seconds(message.times == nullptr ? event.time : message.times[i]).integer(message.ids[i]);
        write_vector(table, message.measurements, i);
        if (message.snr.data == nullptr)
            table.empty();
        else
            table.number(message.snr.data[i * message.snr.item_stride]);
        table.end_row();
    }
}

void CsvSink::finish(const pelorus::Event&) {
    std::vector<Table*> tables{&tracks_, &truth_};
    for (auto& [sensor, table] : scans_) tables.push_back(&table);
    std::string failure;
    for (Table* table : tables) {
        try {
            table->finish();
        } catch (const pelorus::IoError& error) {  // the other files are completed all the same
            if (failure.empty()) failure = error.what();
        }
    }
    if (!failure.empty()) throw pelorus::IoError(failure);
}

}  // namespace sink_csv
