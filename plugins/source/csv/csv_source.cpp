#include "csv_source.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace source_csv {

namespace {

constexpr std::uint64_t logged_rows = 10;  // a broken file must not fill the log; all bad rows are counted

char character(Delimiter delimiter) {
    switch (delimiter) {
        case Delimiter::semicolon:
            return ';';
        case Delimiter::tab:
            return '\t';
        case Delimiter::space:
            return ' ';
        case Delimiter::bar:
            return '|';
        default:
            return ',';
    }
}

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

std::string seconds_text(std::int64_t time) {
    char text[40];
    std::snprintf(text, sizeof text, "%.3f s", static_cast<double>(time) * 1e-9);
    return text;
}

/// Which window of that length a time falls into.
std::int64_t window_index(std::int64_t time, std::int64_t length) {
    return time / length - (time % length < 0 ? 1 : 0);
}

}  // namespace

void CsvSource::setup(const pelorus::Setup& setup) {
    log_ = setup.optional_service<plr_log>();
    diagnostics_ = setup.optional_service<plr_diagnostics>();
    frame_ = setup.frame();
    plan_ = plan_columns(columns_);
    delimiter = character(delimiter_);
    window_ = nanoseconds(window_seconds_);
    if (object && identity_column)
        throw pelorus::ParameterError("object", "names the object of all rows, but so does the column in identity");
    if (duplicates_ == Duplicates::skip && !identifies())
        throw pelorus::ParameterError("duplicates", "are told by identity; name the column in identity");
    if (plan_.tells_truth() && !identifies())
        throw pelorus::ParameterError("identity",
                                      "columns name true components, but no column says of which object; name it, or "
                                      "with object: 1 all rows are of one");
    if (identifies() && plan_.form == Form::spherical && plan_.true_position.empty())
        throw pelorus::ParameterError(
            "columns", "with identity, a spherical recording must tell true positions (true.position.x, ...)");
    if (plan_.form == Form::geodetic)
        geodetic_.setup(setup, origin_);
    else if (origin_)
        throw pelorus::ParameterError("origin", "belongs to latitudes and longitudes, which columns do not name");
    if (start_text_ != "first") {
        try {
            start_ = parse_time(start_text_, time_format);
        } catch (const pelorus::DataError& error) {
            throw pelorus::ParameterError("start", std::string(error.what()) + ", or first");
        }
    }
    try {
        rows_ = std::make_unique<RowReader>(file_, *this, plan_, geodetic_);
    } catch (const pelorus::IoError& error) {
        throw pelorus::ParameterError("file", error.what());
    }
    scan_.emplace(sensor_, frame_, plan_.measurement);
    truth_space_ =
        pelorus::kinematic_space(plan_.true_dimension(), std::vector<double>(plan_.has_velocity() ? 2 : 1, 0.0));
    truth_.emplace(frame_, truth_space_);
}

std::vector<pelorus::Stream> CsvSource::out_streams(std::uint32_t port) const {
    pelorus::Stream stream;
    stream.frame = frame_;
    if (port == scans) {
        stream.sensor = sensor_;
        stream.space = plan_.measurement;
        return {stream};
    }
    if (!identifies()) return {};
    stream.space = truth_space_;
    return {stream};
}

plr_next CsvSource::next() {
    fill();
    if (pending_.empty()) return {sizeof(plr_next), PLR_NEXT_END, 0, 0};
    return {sizeof(plr_next), PLR_NEXT_DATA, pending_.back().arrival - *start_, stamp()};
}

/// The scan's time: that of its last row.
std::int64_t CsvSource::stamp() const {
    std::int64_t latest = pending_.front().time;
    for (const Row& row : pending_) latest = std::max(latest, row.time);
    return latest - *start_;
}

void CsvSource::emit(const pelorus::Event&) {
    fill();
    const std::int64_t time = stamp();
    scan_->clear();
    const double* covariance = plan_.covariance.empty() ? nullptr : plan_.covariance.data();
    for (const Row& row : pending_) {
        if (!row.measured) continue;
        scan_->add(row.line, row.measurement.data(), covariance);
        if (window_ > 0) scan_->set_time(row.time - *start_);
    }
    if (identifies()) {
        add_truth();
        publish(truth, truth_->message(time));
    }
    publish(scans, scan_->message(time));
    pending_.clear();
}

/// One entry for each object and time; several reports of the same time are measurements of one entry.
void CsvSource::add_truth() {
    truth_->clear();
    std::map<std::pair<std::int64_t, std::uint64_t>, pelorus::TruthEntry> entries;
    for (const Row& row : pending_) {
        if (!row.identified) continue;
        pelorus::TruthEntry& entry = entries[{row.time, row.identity}];
        entry.id = entry.parent = row.identity;
        entry.time = row.time - *start_;
        entry.birth = seen_[row.identity].first - *start_;
        if (entry.state == nullptr) entry.state = row.truth.data();
        if (row.measured) entry.measurements.push_back(row.line);
    }
    for (const auto& [key, entry] : entries) truth_->add(entry);
}

/// Reads the rows of the next scan, and the one after it.
void CsvSource::fill() {
    if (!pending_.empty()) return;
    if (!ahead_) ahead_ = fetch();
    while (ahead_ && (pending_.empty() || same_scan(pending_.back(), *ahead_))) {
        pending_.push_back(*ahead_);
        ahead_ = fetch();
    }
}

bool CsvSource::same_scan(const Row& a, const Row& b) const {
    if (window_ == 0) return a.time == b.time;
    return window_index(a.time - *start_, window_) == window_index(b.time - *start_, window_);
}

/// The next row that is used.
std::optional<Row> CsvSource::fetch() {
    Row row;
    while (!ended_) {
        switch (rows_->next(row)) {
            case RowReader::Answer::end:
                ended_ = true;
                break;
            case RowReader::Answer::bad:
                refuse_row(rows_->problem());
                break;
            case RowReader::Answer::row:
                if (accept(row)) return row;
                break;
            case RowReader::Answer::unwanted:
                ++counted_.unselected;  // meant so, and no counter of the run: large files have millions
                break;
        }
    }
    return std::nullopt;
}

/// Whether the row is used. Sets its arrival.
bool CsvSource::accept(Row& row) {
    if (!start_) start_ = row.time;
    std::int64_t since = 0;
    if (__builtin_sub_overflow(row.time, *start_, &since)) {
        refuse_row(rows_->place(row.line) + ": is more than 292 years away from the start");
        return false;
    }
    if (since < 0 && start_text_ != "first") return count("rows_before_start", counted_.early), false;
    if (duration_ && since > nanoseconds(*duration_)) return ended_ = true, false;
    if (newest_ && row.time < *newest_ && out_of_order_ != OutOfOrder::keep) {
        if (out_of_order_ == OutOfOrder::stop)
            throw pelorus::DataError(rows_->place(row.line) + ": column '" + time_column + "': time runs backward by " +
                                     seconds_text(*newest_ - row.time) + " (out_of_order: skip or keep would go on)");
        return count("out_of_order", counted_.backward), false;
    }
    if (row.identified) {
        const auto [seen, is_new] = seen_.emplace(row.identity, Seen{row.time, row.time});
        if (!is_new && duplicates_ == Duplicates::skip && seen->second.last == row.time)
            return count("duplicates", counted_.duplicate), false;
        seen->second.last = row.time;
    }
    newest_ = std::max(newest_.value_or(row.time), row.time);
    row.arrival = *newest_;
    count("rows", counted_.rows);
    return true;
}

void CsvSource::refuse_row(const std::string& problem) {
    if (bad_rows_ == BadRows::stop) throw pelorus::DataError(problem + " (bad_rows: skip would go on)");
    count("bad_rows", counted_.bad);
    if (counted_.bad > logged_rows) return;
    log(PLR_LOG_WARNING, problem + "; the row is left out");
    if (counted_.bad == logged_rows) log(PLR_LOG_WARNING, "further bad rows are only counted");
}

void CsvSource::finish(const pelorus::Event&) {
    const Counts& c = counted_;
    if (c.rows == 0 && c.unselected > 0)
        log(PLR_LOG_WARNING, file_.string() + ": no row was used; " + std::to_string(c.unselected) +
                                 " rows do not have the values that select asks for");
    else if (c.rows == 0)
        log(PLR_LOG_WARNING, file_.string() + ": no row was used");
    if (c.bad + c.backward + c.duplicate + c.early == 0) return;
    log(PLR_LOG_WARNING, file_.string() + ": " + std::to_string(c.rows) +
                             " rows used; left out: " + std::to_string(c.bad) + " bad, " + std::to_string(c.backward) +
                             " out of order, " + std::to_string(c.duplicate) + " duplicate, " +
                             std::to_string(c.early) + " before the start");
}

void CsvSource::count(const char* name, std::uint64_t& counter) const {
    ++counter;
    if (diagnostics_ != nullptr) diagnostics_->count(diagnostics_->context, name, 1);
}

void CsvSource::log(int level, const std::string& line) const {
    if (log_ != nullptr && level >= log_->level) log_->write(log_->context, level, line.c_str());
}

}  // namespace source_csv
