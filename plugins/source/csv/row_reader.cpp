#include "row_reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <pelorus/failure.hpp>
#include <pelorus/sensor.hpp>

namespace source_csv {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double slack = 1 + 1e-12;  // 90 deg in radians may be a digit above pi / 2

std::string shown(std::string_view text) { return "'" + std::string(text.substr(0, 80)) + "'"; }

/// Limits of a component, in SI, or why the number cannot be.
void check(Component component, double value) {
    const auto within = [&](double low, double high, const char* text) {
        if (!(value >= low * slack && value <= high * slack)) throw pelorus::DataError(text);
    };
    switch (component) {
        case Component::latitude:
            return within(-pi / 2, pi / 2, "is beyond the poles");
        case Component::longitude:
            return within(-pi, 2 * pi, "is not within -180 deg to 360 deg");
        case Component::elevation:
            return within(-pi / 2, pi / 2, "is not within -90 deg to 90 deg");
        case Component::zenith:
            return within(0, pi, "is not within 0 deg to 180 deg");
        case Component::range:
        case Component::true_speed:
            if (value < 0) throw pelorus::DataError("is negative");
            return;
        default:
            return;
    }
}

}  // namespace

RowReader::RowReader(const std::filesystem::path& path, const RowSettings& settings, const ColumnPlan& plan,
                     const GeodeticFrame& geodetic)
    : header_(settings.header),
      time_format_(settings.time_format),
      object_(settings.object),
      reader_(path, settings.delimiter, settings.comment),
      plan_(plan),
      geodetic_(geodetic) {
    if (header_) read_header(path);
    time_ = locate(settings.time_column, "time");
    if (settings.identity_column) identity_ = locate(*settings.identity_column, "identity");
    for (std::size_t i = 0; i < settings.select.size(); ++i) {
        const Selection& given = settings.select[i];
        const auto same = [&](const Wanted& wanted) { return wanted.column.name == given.column; };
        auto found = std::find_if(select_.begin(), select_.end(), same);
        if (found == select_.end())
            found =
                select_.insert(select_.end(), {locate(given.column, "select[" + std::to_string(i) + "].column"), {}});
        found->values.push_back(given.value);
    }
    measured_ = locate(plan.measured);
    true_position_ = locate(plan.true_position);
    true_velocity_ = locate(plan.true_velocity);
    if (plan.true_speed) true_speed_ = locate({*plan.true_speed}).front();
    if (plan.true_course) true_course_ = locate({*plan.true_course}).front();
}

void RowReader::read_header(const std::filesystem::path& path) {
    const CsvReader::Answer answer = reader_.next();
    if (answer == CsvReader::Answer::end) throw pelorus::IoError("cannot read " + path.string() + ": it is empty");
    if (answer == CsvReader::Answer::malformed)
        throw pelorus::IoError("cannot read " + path.string() + ", its header: " + reader_.problem());
    for (std::size_t i = 0; i < reader_.size(); ++i) names_.emplace_back(reader_[i]);
}

RowReader::Source RowReader::locate(const std::string& column, const std::string& parameter) const {
    Source source;
    source.name = column;
    if (!header_) {
        std::size_t number = 0;
        const auto [end, error] = std::from_chars(column.data(), column.data() + column.size(), number);
        if (error != std::errc() || end != column.data() + column.size() || number < 1 || number > 100000)
            throw pelorus::ParameterError(parameter,
                                          "without a header, columns are numbers from 1, got " + shown(column));
        source.index = number - 1;
        return source;
    }
    const auto found = std::find(names_.begin(), names_.end(), column);
    if (found == names_.end()) {
        std::string known;
        for (const std::string& name : names_) known += (known.empty() ? "" : ", ") + name;
        throw pelorus::ParameterError(parameter,
                                      "the file has no column " + shown(column) + "; it has " + known.substr(0, 300) +
                                          (names_.size() == 1 ? ", one column only; is the delimiter right?" : ""));
    }
    if (std::count(names_.begin(), names_.end(), column) > 1)
        throw pelorus::ParameterError(parameter, "the file has several columns " + shown(column));
    source.index = static_cast<std::size_t>(found - names_.begin());
    return source;
}

std::vector<RowReader::Source> RowReader::locate(const std::vector<NumberColumn>& columns) const {
    std::vector<Source> sources;
    for (const NumberColumn& column : columns) {
        sources.push_back(locate(column.column, "columns"));
        sources.back().factor = column.factor;
        sources.back().component = column.component;
    }
    return sources;
}

RowReader::Answer RowReader::next(Row& row) {
    const CsvReader::Answer answer = reader_.next();
    if (answer == CsvReader::Answer::end) return Answer::end;
    if (answer == CsvReader::Answer::malformed) {
        problem_ = place(reader_.line()) + ": " + reader_.problem();
        return Answer::bad;
    }
    try {
        if (!wanted()) return Answer::unwanted;
        row = Row{};
        row.line = reader_.line();
        read(row);
        return Answer::row;
    } catch (const pelorus::DataError& error) {
        problem_ = place(reader_.line()) + ": " + error.what();
        return Answer::bad;
    }
}

std::string_view RowReader::cell(const Source& source) const {
    if (source.index >= reader_.size())
        throw pelorus::DataError("column '" + source.name + "': the row has only " + std::to_string(reader_.size()) +
                                 " fields");
    return reader_[source.index];
}

double RowReader::number(const Source& source) const {
    const std::string_view text = cell(source);
    std::string_view digits = text;
    if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const std::string where = "column '" + source.name + "': " + shown(text) + " ";
    if (text.empty()) throw pelorus::DataError("column '" + source.name + "': is empty");
    if (error != std::errc() || end != digits.data() + digits.size()) throw pelorus::DataError(where + "is no number");
    if (!std::isfinite(value)) throw pelorus::DataError(where + "is not finite");
    value *= source.factor;
    try {
        check(source.component, value);
    } catch (const pelorus::DataError& problem) {
        throw pelorus::DataError(where + problem.what());
    }
    return value;
}

bool RowReader::wanted() const {
    return std::all_of(select_.begin(), select_.end(), [&](const Wanted& wanted) {
        return std::find(wanted.values.begin(), wanted.values.end(), cell(wanted.column)) != wanted.values.end();
    });
}

void RowReader::read(Row& row) const {
    try {
        row.time = parse_time(cell(time_), time_format_);
    } catch (const pelorus::DataError& error) {
        throw pelorus::DataError("column '" + time_.name + "': " + error.what());
    }
    row.identified = object_ || (identity_ && !is_blank(*identity_));
    if (row.identified) row.identity = object_ ? static_cast<std::uint64_t>(*object_) : read_identity();
    const bool none = std::all_of(measured_.begin(), measured_.end(), [&](const Source& s) { return is_blank(s); });
    row.measured = !(none && row.identified && !true_position_.empty());
    std::array<double, 3> position{};
    if (row.measured) read_measurement(row, position);
    if (row.identified) read_truth(row, position);
}

std::uint64_t RowReader::read_identity() const {
    const std::string_view text = cell(*identity_);
    std::uint64_t identity = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), identity);
    if (error != std::errc() || end != text.data() + text.size())
        throw pelorus::DataError("column '" + identity_->name + "': " + shown(text) +
                                 " is no identity: expected a whole number from 0");
    return identity;
}

/// `position` answers where the measurement says that the object is, as far as it is a position.
void RowReader::read_measurement(Row& row, std::array<double, 3>& position) const {
    std::array<double, most_measured> values{};
    for (std::size_t i = 0; i < measured_.size(); ++i) {
        values[i] = number(measured_[i]);
        if (measured_[i].component == Component::bearing) values[i] = pelorus::wrap_angle(pi / 2 - values[i]);
        if (measured_[i].component == Component::azimuth) values[i] = pelorus::wrap_angle(values[i]);
    }
    if (plan_.form == Form::geodetic) {
        const double height = measured_.size() == 3 ? values[2] : geodetic_.origin_height();
        const std::array<double, 3> local = geodetic_.position(values[0], values[1], height);
        std::copy(local.begin(), local.end(), values.begin());
    }
    std::copy(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(measured_.size()), row.measurement.begin());
    if (plan_.form != Form::spherical) std::copy(values.begin(), values.begin() + 3, position.begin());
}

void RowReader::read_truth(Row& row, const std::array<double, 3>& position) const {
    const auto dimension = static_cast<std::size_t>(plan_.true_dimension());
    for (std::size_t i = 0; i < dimension; ++i)
        row.truth[i] = true_position_.empty() ? position[i] : number(true_position_[i]);
    for (std::size_t i = 0; i < true_velocity_.size(); ++i) row.truth[dimension + i] = number(true_velocity_[i]);
    if (true_speed_) {
        const double speed = number(*true_speed_), course = number(*true_course_);
        row.truth[dimension] = speed * std::sin(course);
        row.truth[dimension + 1] = speed * std::cos(course);
    }
}

}  // namespace source_csv
