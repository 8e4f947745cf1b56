/// source.csv: plays back a recording from a text file. See README.md.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <pelorus/stage.hpp>

#include "row_reader.hpp"

namespace source_csv {

enum class Delimiter { comma, semicolon, tab, space, bar };
enum class BadRows { stop, skip };
enum class OutOfOrder { stop, skip, keep };
enum class Duplicates { keep, skip };

class CsvSource : public pelorus::Stage<CsvSource>, public RowSettings {
public:
    static constexpr const char* kind = "source";
    enum Port : std::uint32_t { scans, truth };

    static void describe(pelorus::Describe<CsvSource>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const;

    plr_next next();
    void emit(const pelorus::Event& event);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        CsvReader::Place place = rows_->position();
        std::uint64_t size = rows_->file_size();
        archive(size, place, start_, newest_, pending_, ahead_, ended_, seen_, counted_);
        if constexpr (Archive::reading) {
            if (size != rows_->file_size())
                throw pelorus::DataError("the recording " + file_.string() + " has changed since the state was saved");
            rows_->seek(place);
        }
    }

private:
    /// When an identity was seen.
    struct Seen {
        std::int64_t first = 0, last = 0;
        template <class Archive> void state(Archive& archive) { archive(first, last); }
    };
    struct Counts {
        std::uint64_t rows = 0, bad = 0, backward = 0, duplicate = 0, early = 0, unselected = 0;
        template <class Archive> void state(Archive& archive) {
            archive(rows, bad, backward, duplicate, early, unselected);
        }
    };

    void fill();
    std::optional<Row> fetch();
    bool accept(Row& row);
    bool same_scan(const Row& a, const Row& b) const;
    std::int64_t stamp() const;
    void refuse_row(const std::string& problem);
    void count(const char* name, std::uint64_t& counter) const;
    void log(int level, const std::string& line) const;
    void add_truth();

    // parameters
    std::filesystem::path file_;
    Delimiter delimiter_ = Delimiter::comma;
    std::vector<ColumnRow> columns_;
    std::string start_text_, sensor_;
    std::optional<double> duration_;             // s
    std::optional<std::vector<double>> origin_;  // rad, rad, m
    double window_seconds_ = 0;
    BadRows bad_rows_ = BadRows::stop;
    OutOfOrder out_of_order_ = OutOfOrder::stop;
    Duplicates duplicates_ = Duplicates::keep;

    ColumnPlan plan_;
    GeodeticFrame geodetic_;
    std::unique_ptr<RowReader> rows_;
    std::optional<pelorus::ScanBuilder> scan_;
    std::optional<pelorus::TruthBuilder> truth_;
    pelorus::Space truth_space_;
    std::string frame_;
    std::int64_t window_ = 0;  // ns
    const plr_log* log_ = nullptr;
    const plr_diagnostics* diagnostics_ = nullptr;

    // state
    std::optional<std::int64_t> start_, newest_;  // ns as the file counts
    std::vector<Row> pending_;                    // the scan that comes next
    std::optional<Row> ahead_;                    // the first row after it
    bool ended_ = false;
    std::map<std::uint64_t, Seen> seen_;
    Counts counted_;
};

}  // namespace source_csv
