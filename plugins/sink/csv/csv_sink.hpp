/// sink.csv: writes tracks, truth and scans as tables of text. See README.md.
#pragma once

#include <map>
#include <string>

#include <pelorus/result_file.hpp>
#include <pelorus/stage.hpp>

namespace sink_csv {

enum class Uncertainty { none, deviations, covariance };

/// A file with one header. Rows of another header are refused.
class Table {
public:
    template <class... Arguments> void setup(const Arguments&... arguments) { file_.setup(arguments...); }
    const pelorus::ResultFile& file() const noexcept { return file_; }

    /// To be called before the rows of each message. Throws DataError where the header is not that of the rows so far.
    void begin(const std::string& header);
    /// The header that a table without rows shall have.
    void expect(const std::string& header) {
        if (header_.empty()) header_ = header;
    }
    void finish();

    // A row: cells, each behind its separator, and the end of the line.
    Table& seconds(std::int64_t time) { return separate(), file_.seconds(time), *this; }
    Table& number(double value) { return separate(), file_.number(value), *this; }
    template <class Integer> Table& integer(Integer value) { return separate(), file_.integer(value), *this; }
    Table& text(std::string_view value);
    Table& empty() { return separate(), *this; }
    /// Ids first .. last - 1 of a list, with blanks between.
    Table& ids(const std::uint64_t* list, std::int64_t first, std::int64_t last);
    void end_row() {
        file_.write("\n");
        in_row_ = false;
    }

    template <class Archive> void state(Archive& archive) { archive(file_, header_); }

private:
    void separate() {
        if (in_row_) file_.write(",");
        in_row_ = true;
    }
    pelorus::ResultFile file_;
    std::string header_;
    bool in_row_ = false;
};

class CsvSink : public pelorus::Stage<CsvSink> {
public:
    static constexpr const char* kind = "sink";
    static void describe(pelorus::Describe<CsvSink>& plugin);
    void setup(const pelorus::Setup& setup);

    void on_tracks(const pelorus::Event& event, const plr_tracks& message);
    void on_truth(const pelorus::Event& event, const plr_truth& message);
    void on_scan(const pelorus::Event& event, const plr_scan& message);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        archive(tracks_, truth_);
        std::vector<std::string> sensors;
        for (const auto& [sensor, table] : scans_) sensors.push_back(sensor);
        archive(sensors);
        if constexpr (Archive::reading) scans_.clear();
        for (const std::string& sensor : sensors) archive(scans_of(sensor));
    }

private:
    std::string tracks_header(const plr_tracks& message) const;
    void write_uncertainty(const plr_const_view& covariance, std::int64_t i);
    Table& scans_of(const std::string& sensor);

    std::string tracks_name_, truth_name_, scans_name_;
    Uncertainty uncertainty_ = Uncertainty::deviations;

    Table tracks_, truth_;
    std::map<std::string, Table> scans_;  // by sensor
};

}  // namespace sink_csv
