#include "plane_analyzer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <boost/math/distributions/chi_squared.hpp>

namespace plane_motion {

namespace {

const std::vector<std::string> status_texts = {"tested",
                                               "line: in many planes, rejected less often than the level says",
                                               "fewer than 4 points",
                                               "fewer than 4 different points",
                                               "no variance across the plane",
                                               "numbers out of range"};

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }
double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

/// A time (s) as part of a name: 50, 0_5.
std::string name_of(double time) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", time);
    std::string name = text;
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
}

}  // namespace

void PlaneAnalyzer::describe(pelorus::Describe<PlaneAnalyzer>& plugin) {
    plugin.title("Plane motion")
        .purpose(
            "Is a target moving in a plane? Fits a plane to the measured places within a window of time and tests the "
            "residual against chi-square; at the end of a run or on line, and then its decision can drive a tracker.")
        .equation(
            "errors in variables: min over n, d of sum (n'z - d)^2 / (n'C n), chi-square with points - 3 degrees of "
            "freedom; regression: the least of three sums (x - a - b y - c z)^2 / C_xx, by x, y and z")
        .source(
            "errors in variables: W. Chojnacki, M. J. Brooks, A. van den Hengel, D. Gawley, On the fitting of surfaces "
            "to data with covariances, IEEE Transactions on Pattern Analysis and Machine Intelligence 22(11), "
            "1294-1303, "
            "2000");
    plugin.in_port("scans", PLR_MESSAGE_SCAN, "measurements of one target", PLR_PORT_MANY);
    plugin.out_port("results", PLR_MESSAGE_TABLE, "the table windows and its scalars, at the end");
    plugin.out_port(
        "plane", PLR_MESSAGE_VALUES,
        "after each test: plane_normal, plane_offset [m], and plane_holds: 1 where the points are in one plane, 0 "
        "where that was rejected or not tested, or they may be on a line");
    plugin.slot("sensors", "sensor", 0, -1,
                "the sensors of the scans, matched by name, which convert measurements to points; none: scans of "
                "positions with covariances");
    plugin.parameter("statistic", &PlaneAnalyzer::statistic_)
        .initially("errors_in_variables")
        .choices({{"errors_in_variables", "distances from the plane over their variances, all errors counted"},
                  {"regression",
                   "as published: one coordinate over the other two as if these were exact; rejects planes, too"}})
        .doc("what is tested");
    plugin.parameter("level", &PlaneAnalyzer::level_)
        .initially("0.05")
        .above(0)
        .below(1)
        .doc("probability with which a plane is rejected");
    describe_windows(plugin);
}

void PlaneAnalyzer::describe_windows(pelorus::Describe<PlaneAnalyzer>& plugin) {
    plugin.parameter("window", &PlaneAnalyzer::window_)
        .initially("fixed")
        .choices({{"fixed", "those in `windows`"},
                  {"growing", "from `from` to the newest measurement"},
                  {"sliding", "the last `length` seconds"}})
        .doc("which measurements are tested together");
    auto windows = plugin.table("windows", &PlaneAnalyzer::windows_);
    windows.initially("[]").doc(
        "fixed: starts and ends, as in [[0 s, 40 s], [0 s, 75 s]], each with an end of its own");
    windows.column("start", &WindowRow::start).unit("s").doc("first time that counts");
    windows.column("end", &WindowRow::end).unit("s").doc("last time that counts");
    plugin.parameter("from", &PlaneAnalyzer::from_).unit("s").doc("growing: first time that counts; 0 s if absent");
    plugin.parameter("length", &PlaneAnalyzer::length_)
        .unit("s")
        .min(1e-9)
        .max(9e9)
        .doc("sliding: measurements older than so much before the newest do not count");
    plugin.parameter("every", &PlaneAnalyzer::every_)
        .initially("1")
        .min(1)
        .doc("growing, sliding: so many new measurements from one test to the next");
    plugin.parameter("capacity", &PlaneAnalyzer::capacity_)
        .initially("1000")
        .min(4)
        .max(1e9)
        .doc(
            "growing, sliding: most measurements in a window; the oldest ones give way, and a window that cannot grow "
            "slides");
    plugin.parameter("scalars_at", &PlaneAnalyzer::scalars_at_)
        .unit("s")
        .rows(0, 100)
        .doc(
            "ends of windows whose results become scalars, rejection_rate_40 for 40 s; growing, sliding: the last test "
            "up to then; absent: all fixed windows");
}

void PlaneAnalyzer::setup(const pelorus::Setup& setup) {
    check_parameters();
    points_.setup(setup);
}

void PlaneAnalyzer::check_parameters() const {
    const bool fixed = window_ == Window::fixed;
    if (fixed && windows_.empty())
        throw pelorus::ParameterError("windows", "is missing; window: fixed needs at least one");
    if (!fixed && !windows_.empty()) throw pelorus::ParameterError("windows", "belongs to window: fixed");
    if (from_ && window_ != Window::growing) throw pelorus::ParameterError("from", "belongs to window: growing");
    if (length_ && window_ != Window::sliding) throw pelorus::ParameterError("length", "belongs to window: sliding");
    if (!length_ && window_ == Window::sliding)
        throw pelorus::ParameterError("length", "is missing; window: sliding needs it");
    for (std::size_t i = 0; i < windows_.size(); ++i) {
        const std::string name = "windows[" + std::to_string(i) + "].end";
        if (!(std::fabs(windows_[i].start) < 9e9 && std::fabs(windows_[i].end) < 9e9))
            throw pelorus::ParameterError(name, "or its start is beyond what a clock of nanoseconds can tell (9e9 s)");
        if (!(windows_[i].end > windows_[i].start)) throw pelorus::ParameterError(name, "is not after its start");
        for (std::size_t k = 0; k < i; ++k)
            if (windows_[k].end == windows_[i].end)
                throw pelorus::ParameterError(
                    name, "is that of windows[" + std::to_string(k) + "], too; results are named by it");
    }
    for (const double at : scalars_at_.value_or(std::vector<double>()))
        if (std::count(scalars_at_->begin(), scalars_at_->end(), at) > 1)
            throw pelorus::ParameterError("scalars_at", "has a time twice; results are named by it");
    if (from_ && !(std::fabs(*from_) < 9e9))
        throw pelorus::ParameterError("from", "is beyond what a clock of nanoseconds can tell (9e9 s)");
}

void PlaneAnalyzer::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    for (const Sample& sample : points_.read(event.time, scan)) keep(sample);
    if (window_ == Window::fixed) {
        latest_ = std::max(latest_, event.time);  // empty scans, too, tell that a window is over
        return test_fixed(latest_);
    }
    if (fresh_ >= every_) test_newest();
}

/// In the order of times; belated ones find their place.
void PlaneAnalyzer::keep(const Sample& sample) {
    if (window_ == Window::growing && sample.time < nanoseconds(from_.value_or(0))) return;
    const auto after = std::upper_bound(samples_.begin(), samples_.end(), sample.time,
                                        [](std::int64_t time, const Sample& other) { return time < other.time; });
    samples_.insert(after, sample);
    latest_ = std::max(latest_, sample.time);
    ++fresh_;
    forget();
}

/// What no window will need any more.
void PlaneAnalyzer::forget() {
    if (window_ == Window::fixed) {
        std::int64_t needed = std::numeric_limits<std::int64_t>::max();
        for (const WindowRow& row : windows_)
            if (nanoseconds(row.end) >= latest_) needed = std::min(needed, nanoseconds(row.start));
        // Windows that end with this sample's predecessor have not been tested yet.
        for (const WindowRow& row : windows_)
            if (verdicts_.count({nanoseconds(row.end), nanoseconds(row.start)}) == 0)
                needed = std::min(needed, nanoseconds(row.start));
        while (!samples_.empty() && samples_.front().time < needed) samples_.pop_front();
        return;
    }
    if (window_ == Window::sliding)
        while (!samples_.empty() && samples_.front().time <= latest_ - nanoseconds(*length_)) samples_.pop_front();
    while (static_cast<std::int64_t>(samples_.size()) > capacity_) samples_.pop_front();
}

/// Windows that end now, and those that are over and have not been tested. Another scan at a window's end has it tested again.
void PlaneAnalyzer::test_fixed(std::int64_t now) {
    for (const WindowRow& row : windows_) {
        const std::int64_t start = nanoseconds(row.start), end = nanoseconds(row.end);
        if (end == now || (end < now && verdicts_.count({end, start}) == 0)) test(start, end, false);
    }
}

void PlaneAnalyzer::test_newest() {
    fresh_ = 0;
    if (window_ == Window::growing) return test(nanoseconds(from_.value_or(0)), latest_, false);
    test(latest_ - nanoseconds(*length_), latest_, true);
}

/// `is_open`: the start itself does not count.
void PlaneAnalyzer::test(std::int64_t start, std::int64_t end, bool is_open) {
    const auto before = [](const Sample& sample, std::int64_t time) { return sample.time < time; };
    const auto first = std::lower_bound(samples_.cbegin(), samples_.cend(), is_open ? start + 1 : start, before);
    const auto last = std::lower_bound(samples_.cbegin(), samples_.cend(), end + 1, before);
    const Samples within{first, std::max(first, last)};
    const Fit fit = statistic_ == Statistic::regression ? regression(within) : errors_in_variables(within);
    Verdict verdict;
    verdict.start = start;
    verdict.end = end;
    verdict.first = within.size() == 0 ? start : first->time;
    verdict.samples = within.size();
    verdict.status = static_cast<std::uint32_t>(fit.status);
    verdict.statistic = fit.statistic;
    verdict.normal = fit.normal;
    verdict.offset = fit.offset;
    if (is_tested(fit.status)) {
        verdict.degrees = fit.degrees_of_freedom;
        verdict.critical = critical(fit.degrees_of_freedom, level_);
        // A plane is not determined by points that may be on a line: that is taken back only where it is out of the question.
        const auto points = static_cast<int>(within.size());
        if (line_statistic(within) < critical(2 * points - 4, level_ / 1000))
            verdict.status = static_cast<std::uint32_t>(Status::line);
    }
    verdicts_[{end, start}] = verdict;
    tell_plane(verdict);
}

/// What chi-square exceeds with the probability `level`.
double PlaneAnalyzer::critical(int degrees, double level) {
    const auto [found, is_new] = quantiles_.try_emplace({degrees, level}, 0.0);
    if (is_new)
        found->second = boost::math::quantile(boost::math::complement(boost::math::chi_squared(degrees), level));
    return found->second;
}

void PlaneAnalyzer::tell_plane(const Verdict& verdict) {
    const bool holds = static_cast<Status>(verdict.status) == Status::tested && !verdict.is_rejected();
    pelorus::ValuesBuilder values;
    values.add("", "plane_normal", "", verdict.normal, verdict.end);
    values.add("", "plane_offset", "m", Eigen::MatrixXd::Constant(1, 1, verdict.offset), verdict.end);
    values.add("", "plane_holds", "", Eigen::MatrixXd::Constant(1, 1, holds ? 1 : 0), verdict.end);
    publish(plane_out, values.message(verdict.end));
}

void PlaneAnalyzer::finish(const pelorus::Event& event) {
    if (window_ == Window::fixed) test_fixed(std::numeric_limits<std::int64_t>::max());
    pelorus::ResultBuilder table("windows");
    for (const char* name : {"start", "end"}) table.column(name, "s", PLR_REDUCE_KEY);
    table.column("first", "s", PLR_REDUCE_FIRST_RUN);
    for (const char* name : {"samples", "statistic", "critical_value", "degrees_of_freedom", "decision"})
        table.column(name, "", PLR_REDUCE_MEAN);
    for (const char* name : {"normal.x", "normal.y", "normal.z"}) table.column(name, "", PLR_REDUCE_FIRST_RUN);
    table.column("offset", "m", PLR_REDUCE_FIRST_RUN);
    table.text_column("status", PLR_REDUCE_FIRST_RUN, status_texts);
    for (const auto& [when, v] : verdicts_)
        table.row({seconds(v.start), seconds(v.end), seconds(v.first), static_cast<double>(v.samples), v.statistic,
                   v.critical, v.degrees, v.is_rejected() ? 1.0 : 0.0, v.normal(0), v.normal(1), v.normal(2), v.offset,
                   static_cast<double>(v.status)});
    add_scalars(table);
    publish(results_out, table.message(event.time));
}

/// Of tests that could be done: where there was none, there is nothing to tell, and the run does not count.
void PlaneAnalyzer::add_scalars(pelorus::ResultBuilder& table) const {
    std::vector<double> times = scalars_at_.value_or(std::vector<double>());
    if (!scalars_at_)
        for (const WindowRow& row : windows_) times.push_back(row.end);
    for (const double at : times) {
        const Verdict* const verdict = verdict_at(nanoseconds(at));
        const std::string name = name_of(at);
        table.scalar("tested_" + name, "", PLR_REDUCE_MEAN, verdict == nullptr ? 0 : 1);
        table.scalar("rejection_rate_" + name, "", PLR_REDUCE_MEAN,
                     verdict == nullptr       ? nothing
                     : verdict->is_rejected() ? 1
                                              : 0);
        table.scalar("mean_statistic_" + name, "", PLR_REDUCE_MEAN, verdict == nullptr ? nothing : verdict->statistic);
        table.scalar("critical_value_" + name, "", PLR_REDUCE_MEAN, verdict == nullptr ? nothing : verdict->critical);
    }
}

/// The test of the fixed window that ends then, or the last one up to then of a run that went on until then; nullptr where it
/// could not be done.
const PlaneAnalyzer::Verdict* PlaneAnalyzer::verdict_at(std::int64_t limit) const {
    const auto after = verdicts_.upper_bound({limit, std::numeric_limits<std::int64_t>::max()});
    if (after == verdicts_.begin()) return nullptr;
    const Verdict& verdict = std::prev(after)->second;
    const bool is_meant = window_ == Window::fixed ? verdict.end == limit : latest_ >= limit;
    return is_meant && is_tested(static_cast<Status>(verdict.status)) ? &verdict : nullptr;
}

}  // namespace plane_motion
