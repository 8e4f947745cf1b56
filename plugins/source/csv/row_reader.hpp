/// Rows of a recording, read as times, measurements, identities and truth.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "columns.hpp"
#include "csv_reader.hpp"
#include "geodetic.hpp"
#include "time_text.hpp"

namespace source_csv {

constexpr std::size_t most_measured = 4;  // range, range rate, azimuth, elevation or zenith
constexpr std::size_t most_true = 6;      // positions and velocities

/// What one row says, in SI.
struct Row {
    std::int64_t time = 0;     ///< ns, as the file counts
    std::int64_t arrival = 0;  ///< ns, latest time up to this row
    std::uint64_t line = 0;
    std::uint64_t identity = 0;
    bool measured = false;    ///< false: the row tells the truth about an object that was not seen
    bool identified = false;  ///< false: nobody knows what was seen
    std::array<double, most_measured> measurement{};
    std::array<double, most_true> truth{};  ///< positions, then velocities

    template <class Archive> void state(Archive& archive) {
        archive(time, arrival, line, identity, measured, identified, measurement, truth);
    }
};

/// A row is wanted if, for each column named here, its text is one of those listed for that column.
struct Selection {
    std::string column, value;
};

struct RowSettings {
    bool header = true;
    char delimiter = ',';
    std::string comment;
    std::string time_column;
    TimeFormat time_format = TimeFormat::iso8601;
    std::optional<std::string> identity_column;
    std::optional<int> object;  ///< identity of every row, where no column tells one
    bool identifies() const noexcept { return identity_column || object; }
    std::vector<Selection> select;
};

class RowReader {
public:
    /// Opens the file and reads its header. `geodetic` is used for latitudes and longitudes only, and must outlive the
    /// reader. Throws IoError; ParameterError for a column that is not there, naming those that are.
    RowReader(const std::filesystem::path& path, const RowSettings& settings, const ColumnPlan& plan,
              const GeodeticFrame& geodetic);

    enum class Answer { row, unwanted, bad, end };
    /// Throws IoError where the system cannot read.
    Answer next(Row& row);
    /// `FILE:LINE: column 'x': 'abc' is no number`
    const std::string& problem() const noexcept { return problem_; }
    std::string place(std::uint64_t line) const { return reader_.file().path().string() + ":" + std::to_string(line); }

    std::uint64_t file_size() const noexcept { return reader_.file().size(); }
    CsvReader::Place position() const noexcept { return reader_.place(); }
    void seek(const CsvReader::Place& place) { reader_.seek(place); }

private:
    struct Source {
        std::size_t index = 0;  // of the file's column
        std::string name;
        double factor = 1;
        Component component = Component::x;
    };
    struct Wanted {
        Source column;
        std::vector<std::string> values;
    };

    Source locate(const std::string& column, const std::string& parameter) const;
    std::vector<Source> locate(const std::vector<NumberColumn>& columns) const;
    void read_header(const std::filesystem::path& path);
    std::string_view cell(const Source& source) const;
    bool is_blank(const Source& source) const { return cell(source).empty(); }
    double number(const Source& source) const;
    bool wanted() const;
    void read(Row& row) const;
    void read_measurement(Row& row, std::array<double, 3>& position) const;
    void read_truth(Row& row, const std::array<double, 3>& position) const;
    std::uint64_t read_identity() const;

    bool header_;
    TimeFormat time_format_;
    CsvReader reader_;
    std::vector<std::string> names_;
    const ColumnPlan plan_;
    const GeodeticFrame& geodetic_;
    Source time_;
    std::optional<Source> identity_;
    std::optional<int> object_;
    std::vector<Wanted> select_;
    std::vector<Source> measured_, true_position_, true_velocity_;
    std::optional<Source> true_speed_, true_course_;
    std::string problem_;
};

}  // namespace source_csv
