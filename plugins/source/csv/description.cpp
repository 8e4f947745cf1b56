// What source.csv says of itself.
#include "csv_source.hpp"

namespace source_csv {

namespace {

const std::string purpose =
    "Plays a recording back from a text file with delimiters, plain or gzip, row by row and in constant memory. Rows "
    "of "
    "equal time, or of one window, become a scan. Columns are mapped to measured components, each with its unit; "
    "latitudes and longitudes become coordinates of a local frame. A column that says of which object a row is becomes "
    "the truth that analyzers compare with; trackers do not see it.";

void describe_file(pelorus::Describe<CsvSource>& plugin, std::filesystem::path CsvSource::*file,
                   Delimiter CsvSource::*delimiter) {
    plugin.parameter("file", file).doc("the recording; text or gzip, told by its content");
    plugin.parameter("header", &RowSettings::header)
        .initially("true")
        .doc("the first row names the columns; otherwise columns are numbers from 1");
    plugin.parameter("delimiter", delimiter)
        .initially("comma")
        .choices({{"comma", ""}, {"semicolon", ""}, {"tab", ""}, {"space", "any run of spaces and tabs"}, {"bar", "|"}})
        .doc("what stands between fields");
    plugin.parameter("comment", &RowSettings::comment)
        .initially("''")
        .doc("what a line begins with that is not read; empty: there are no comments");
}

void describe_time(pelorus::Describe<CsvSource>& plugin, std::string CsvSource::*start,
                   std::optional<double> CsvSource::*duration, double CsvSource::*window) {
    plugin.parameter("time", &RowSettings::time_column).initially("time").doc("column of the time");
    plugin.parameter("time_format", &RowSettings::time_format)
        .initially("seconds")
        .choices({{"iso8601", "date and time, such as 2016-01-12 13:02:11.218; UTC unless an offset is given"},
                  {"seconds", "a number of seconds since any zero"},
                  {"milliseconds", ""},
                  {"microseconds", ""},
                  {"nanoseconds", ""}})
        .doc("how times are spelled");
    plugin.parameter("start", start)
        .initially("first")
        .doc(
            "the time, spelled as in the file, that is 0 in the run; earlier rows are passed over; first: that of the "
            "first row");
    plugin.parameter("duration", duration)
        .unit("s")
        .min(0.0)
        .doc("later rows are not read; absent: to the end of the file");
    plugin.parameter("window", window)
        .unit("s")
        .initially("0 s")
        .min(0.0)
        .doc(
            "rows within each stretch of this length, counted from the start, form a scan and keep their own times; 0: "
            "rows of equal time do");
}

void describe_columns(pelorus::Describe<CsvSource>& plugin, std::vector<ColumnRow> CsvSource::*columns) {
    auto table = plugin.table("columns", columns);
    table.rows(1).doc("which columns are read as numbers, and what they are");
    table.column("column", &ColumnRow::column).doc("name in the header, or number from 1");
    table.column("component", &ColumnRow::component)
        .choices(component_words())
        .doc("measured: position, or range with angles, or latitude and longitude; or true values, with identity");
    table.column("unit", &ColumnRow::unit).initially("SI").choices(unit_words()).doc("unit of the file's numbers");
    table.column("deviation", &ColumnRow::deviation)
        .doc(
            "standard deviation of a measured component, in the row's unit; of latitude, longitude and height in m; "
            "given "
            "for all or for none (then the sensor model's noise holds)");
}

}  // namespace

void CsvSource::describe(pelorus::Describe<CsvSource>& plugin) {
    plugin.title("Recording in a text file")
        .purpose(purpose)
        .equation("bearing to azimuth: pi/2 - bearing; speed v, course c: velocity = (v sin c, v cos c)")
        .source(
            "Y. Shafranovich, Common Format and MIME Type for CSV Files, RFC 4180, 2005; ISO 8601; local coordinates: "
            "C. F. "
            "F. Karney, GeographicLib, LocalCartesian");
    describe_file(plugin, &CsvSource::file_, &CsvSource::delimiter_);
    describe_columns(plugin, &CsvSource::columns_);
    describe_time(plugin, &CsvSource::start_text_, &CsvSource::duration_, &CsvSource::window_seconds_);
    plugin.parameter("sensor", &CsvSource::sensor_).initially("sensor").doc("name of the sensor that the scans are of");
    plugin.parameter("origin", &CsvSource::origin_)
        .unit("rad, rad, m")
        .rows(3, 3)
        .doc(
            "latitude, longitude and height (WGS84) of the east-north-up frame that geodetic positions are turned "
            "into; "
            "left out where the node's frame stands on Earth");
    plugin.parameter("identity", &RowSettings::identity_column)
        .doc("column that says of which object the row is, as a whole number; empty: nobody knows, a false alarm");
    plugin.parameter("object", &RowSettings::object)
        .min(0)
        .doc("identity of every row, of a recording of one object that has no column for it; instead of identity");
    auto select = plugin.table("select", &RowSettings::select);
    select.initially("[]").doc("only rows whose text in each column named is one of the values given for it");
    select.column("column", &Selection::column).doc("name in the header, or number from 1");
    select.column("value", &Selection::value).doc("a text that is wanted");
    plugin.parameter("out_of_order", &CsvSource::out_of_order_)
        .initially("stop")
        .choices({{"stop", "the run ends with an error"},
                  {"skip", "the row is left out and counted"},
                  {"keep", "the row is a scan of its own that arrives at the latest time so far"}})
        .doc("what happens to a row that is older than one before it");
    plugin.parameter("duplicates", &CsvSource::duplicates_)
        .initially("keep")
        .choices({{"keep", ""}, {"skip", "only the first one counts"}})
        .doc("what happens to further rows of the same identity and time");
    plugin.parameter("bad_rows", &CsvSource::bad_rows_)
        .initially("stop")
        .choices({{"stop", "the run ends with an error that names file, line and column"},
                  {"skip", "the row is left out, told in the log and counted"}})
        .doc("what happens to rows that cannot be read");
    plugin.out_port("scans", PLR_MESSAGE_SCAN, "measurements; their ids are the lines of the file");
    plugin.out_port("truth", PLR_MESSAGE_TRUTH,
                    "who was where, and which measurements came from whom; only with identity");
}

}  // namespace source_csv
