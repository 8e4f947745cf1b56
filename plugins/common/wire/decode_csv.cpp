#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "decode.hpp"
#include "text.hpp"

namespace wire {

namespace {

/// The fields of a line (RFC 4180; a quoted field ends in its line).
std::vector<std::string> split(std::string_view line) {
    std::vector<std::string> fields(1);
    for (std::size_t i = 0; i < line.size(); ++i) {
        std::string& field = fields.back();
        if (line[i] == ',') {
            fields.emplace_back();
        } else if (line[i] == '"' && field.empty()) {
            for (++i; i < line.size() && (line[i] != '"' || (i + 1 < line.size() && line[i + 1] == '"')); ++i) {
                if (line[i] == '"') ++i;
                field += line[i];
            }
            if (i >= line.size()) throw BadFrame("has a quote that is not closed");
            if (i + 1 < line.size() && line[i + 1] != ',') throw BadFrame("has text behind a closing quote");
        } else {
            field += line[i];
        }
    }
    return fields;
}

/// A table by the names of its columns; knows which of them nobody asked for.
class Rows {
public:
    explicit Rows(std::vector<std::string> header) {
        for (std::size_t i = 0; i < header.size(); ++i)
            if (!places_.emplace(header[i], i).second)
                throw BadFrame("has the column '" + shown(header[i]) + "' twice");
        if (header.front() != "pelorus")
            throw BadFrame("begins with neither { nor the column pelorus, but with '" + shown(header.front()) + "'");
    }

    void take(std::vector<std::string> row) {
        if (row.size() != places_.size())
            throw BadFrame("has " + std::to_string(row.size()) + " fields, expected " + std::to_string(places_.size()));
        row_ = std::move(row);
    }
    bool has(const std::string& column) {
        known_.insert(column);
        return places_.count(column) != 0;
    }
    /// "" where there is no such column.
    std::string cell(const std::string& column) { return has(column) ? row_[places_.at(column)] : ""; }

    double number(const std::string& column) { return read<double>(column, "number"); }
    std::uint64_t whole(const std::string& column) {
        return read<std::uint64_t>(column, "whole number from 0 to 2^64 - 1");
    }
    std::optional<std::uint64_t> optional_whole(const std::string& column) {
        if (cell(column).empty()) return std::nullopt;
        return whole(column);
    }
    /// `NAME_ns` in whole nanoseconds or `NAME` in seconds.
    std::optional<std::int64_t> instant(const std::string& name) {
        const std::string exact = name + "_ns";
        const bool fine = !cell(exact).empty(), plain = !cell(name).empty();
        if (fine && plain) throw BadFrame(exact + " and " + name + " are both given");
        std::int64_t time = 0;
        if (fine) time = read<std::int64_t>(exact, "whole number of nanoseconds");
        if (fine && std::abs(time / 2) > std::int64_t{1} << 61) throw BadFrame(exact + " is beyond 2^62");
        if (plain && !nanoseconds(number(name), time)) throw BadFrame(name + " is beyond what nanoseconds can count");
        if (fine || plain) return time;
        return std::nullopt;
    }
    void refuse_unknown() const {
        for (const auto& [column, place] : places_)
            if (known_.count(column) == 0) throw BadFrame("column '" + shown(column) + "' is unknown");
    }

private:
    template <class Number> Number read(const std::string& column, const char* expected) {
        const std::string text = cell(column);
        Number value{};
        const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
        bool good = failure == std::errc() && end == text.data() + text.size();
        if constexpr (std::is_floating_point_v<Number>) good = good && std::isfinite(value);
        if (!good) throw BadFrame(column + " is '" + shown(text) + "', expected a " + expected);
        return value;
    }

    std::map<std::string, std::size_t> places_;
    std::set<std::string> known_;
    std::vector<std::string> row_;
};

void read_envelope(Rows& rows, Datagram& datagram, bool first) {
    Datagram told;
    if (rows.whole("pelorus") != version)
        throw BadFrame("pelorus is " + shown(rows.cell("pelorus")) + ", this reader knows version 1");
    told.sender = rows.cell("sender");
    told.session = rows.optional_whole("session").value_or(0);
    told.sequence = rows.optional_whole("sequence");
    adopt_envelope(told, first, datagram);
}

/// Appends the row's covariance, if it has one: `covariance.A.B` (the upper triangle) or `deviation.A`.
void read_covariance(Rows& rows, const pelorus::Space& space, Frame& frame) {
    const auto n = static_cast<std::size_t>(space.size());
    std::vector<double> matrix(n * n, 0.0);
    std::size_t deviations = 0, covariances = 0;
    for (std::size_t r = 0; r < n; ++r) {
        const std::string& name = space[static_cast<int>(r)].name;
        if (const std::string column = "deviation." + name; !rows.cell(column).empty()) {
            const double deviation = rows.number(column);
            matrix[r * n + r] = deviation * deviation;
            ++deviations;
        }
        for (std::size_t c = r; c < n; ++c) {
            const std::string column = "covariance." + name + "." + space[static_cast<int>(c)].name;
            if (rows.cell(column).empty()) continue;
            matrix[r * n + c] = matrix[c * n + r] = rows.number(column);
            ++covariances;
        }
    }
    if (deviations == 0 && covariances == 0) return;
    const bool whole = deviations == 0 ? covariances == n * (n + 1) / 2 : covariances == 0 && deviations == n;
    if (!whole) throw BadFrame("has a part of its covariance, expected all deviations or the whole upper triangle");
    check_covariance(matrix.data(), n, "covariance");
    frame.covariances.insert(frame.covariances.end(), matrix.begin(), matrix.end());
}

/// Appends the measurement of the row; a row without any component tells of a scan and nothing in it.
void read_measurement(Rows& rows, const pelorus::Space& space, Frame& frame) {
    const std::size_t before = frame.rows();
    std::size_t filled = 0;
    for (const auto& component : space.components()) filled += rows.cell(component.name).empty() ? 0 : 1;
    const std::optional<std::uint64_t> id = rows.optional_whole("id");
    const std::optional<std::int64_t> measured = rows.instant("measured");
    const bool has_snr = !rows.cell("snr").empty();
    if (filled == 0) return;
    for (const auto& component : space.components()) frame.values.push_back(rows.number(component.name));
    read_covariance(rows, space, frame);
    if (id) frame.ids.push_back(*id);
    if (measured) frame.times.push_back(*measured);
    if (has_snr) frame.snr.push_back(rows.number("snr"));
    const std::size_t n = before + 1, cells = static_cast<std::size_t>(frame.width * frame.width);
    const auto partly = [&](std::size_t size, std::size_t one) { return size != 0 && size != n * one; };
    if (partly(frame.ids.size(), 1) || partly(frame.times.size(), 1) || partly(frame.snr.size(), 1) ||
        partly(frame.covariances.size(), cells))
        throw BadFrame("id, measured, snr and covariance must be given for all measurements of a scan or for none");
}

/// The frame that the row belongs to: the last one, if it is of the same scan.
Frame& frame_of_row(Rows& rows, const Vocabulary& vocabulary, Datagram& datagram) {
    Frame frame;
    const std::string kind = rows.cell("kind");
    if (!kind.empty() && kind != "scan" && kind != "end")
        throw BadFrame("kind is '" + shown(kind) + "', expected scan or end");
    frame.kind = kind == "end" ? Kind::end : Kind::scan;
    const auto time = rows.instant("time");
    frame.arrival = rows.instant("arrival");
    if (!time && frame.kind == Kind::scan) throw BadFrame("time_ns (or time, in seconds) is missing");
    frame.time = time.value_or(0);
    const auto number = rows.optional_whole("part"), of = rows.optional_whole("parts");
    if (number || of) frame.part = {number.value_or(0), of.value_or(0)};
    check_part(frame.part);
    if (!datagram.sequence && frame.part[1] > 1) throw BadFrame("has a part, but no sequence to order it by");
    frame.sensor = rows.cell("sensor");
    if (frame.kind == Kind::scan)
        frame.width = static_cast<std::uint64_t>(sensor_of(vocabulary, frame.sensor).measurement.size());
    if (!datagram.frames.empty()) {
        Frame& last = datagram.frames.back();
        if (last.kind == frame.kind && last.time == frame.time && last.arrival == frame.arrival &&
            last.sensor == frame.sensor && last.part == frame.part)
            return last;
    }
    return datagram.frames.emplace_back(std::move(frame));
}

}  // namespace

void decode_csv(std::string_view bytes, const Vocabulary& vocabulary, Datagram& into) {
    std::optional<Rows> rows;
    bool first = true;
    for (std::size_t at = 0, number = 1; at < bytes.size(); ++number) {
        const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
        std::string_view line = bytes.substr(at, end - at);
        at = end + 1;
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        if (line.empty()) continue;
        try {
            if (!rows) {
                rows.emplace(split(line));
                continue;
            }
            rows->take(split(line));
            read_envelope(*rows, into, first);
            first = false;
            Frame& frame = frame_of_row(*rows, vocabulary, into);
            if (frame.kind == Kind::scan)
                read_measurement(*rows, sensor_of(vocabulary, frame.sensor).measurement, frame);
        } catch (const BadFrame& problem) {
            throw BadFrame("line " + std::to_string(number) + ": " + problem.what());
        }
    }
    if (first) throw BadFrame("has a header and no row");
    // An end needs no components: columns of scans may stand there unused.
    const auto is_scan = [](const Frame& frame) { return frame.kind == Kind::scan; };
    if (std::any_of(into.frames.begin(), into.frames.end(), is_scan)) rows->refuse_unknown();
}

}  // namespace wire
