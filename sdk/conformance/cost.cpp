// What a call costs, and how that grows.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "model_calls.hpp"
#include "partitioner_calls.hpp"
#include "trajectory_calls.hpp"

namespace pelorus::conformance {

namespace {

constexpr int repeats = 5, rounds = 6;
/// Of rounds, in s: what grows too fast goes on doing so, and a library has many calls and subjects.
constexpr double time_enough = 0.5;

/// One call in several sizes.
struct Growing {
    std::string function, what;  ///< `predict`, `items`
    std::vector<std::int64_t> sizes;
    std::vector<HotCall> calls;
    double exponent_expected, exponent_warned, exponent_refused;
};

/// Twice as much may take 2^1.2 times as long without a word (caches), 2^1.5 times with a warning. n log n is below both.
Growing linear(const std::string& function, const std::string& what) {
    return {function, what, {512, 1024, 2048, 4096}, {}, 1, 1.2, 1.5};
}

/// As many items as the nearest caches hold with all that the call reads and writes of them, within bounds: beyond, time grows by
/// how far away the memory is, whatever the plugin does.
std::int64_t most_items(const HotCall& call) {
    constexpr std::int64_t cache = 1 << 20, least = 64, most = 4096;
    std::int64_t doubles = 1;
    for (const auto* arguments : {&call.in, &call.out})
        for (const Argument& argument : *arguments)
            if (!argument.is_common && !argument.is_absent) doubles += argument.rows * argument.cols;
    return std::clamp(cache / (doubles * static_cast<std::int64_t>(sizeof(double))), least, most);
}

class Stopwatch {
public:
    Stopwatch(const Instance& instance, const Growing& growing)
        : instance_(instance), growing_(growing), least_(growing.calls.size(), 1e300) {}
    /// Least times so far, of some more repeats.
    void measure() {
        for (int repeat = 0; repeat < repeats; ++repeat)
            for (std::size_t k = 0; k < growing_.calls.size(); ++k) {
                const double seconds = once(growing_.calls[k]);
                least_[k] = std::min(least_[k], seconds);
                spent_ += seconds;
            }
    }
    double spent() const { return spent_; }
    double once(const HotCall& call) const {
        ExecuteOptions options;
        options.is_guarded = false;
        return execute(instance_, call, options).seconds;
    }
    /// The slope of log time over log size, by least squares.
    double exponent() const {
        double x = 0, y = 0, xx = 0, xy = 0;
        const double n = static_cast<double>(least_.size());
        for (std::size_t k = 0; k < least_.size(); ++k) {
            const double u = std::log(static_cast<double>(growing_.sizes[k])), v = std::log(least_[k]);
            x += u, y += v, xx += u * u, xy += u * v;
        }
        return (n * xy - x * y) / (n * xx - x * x);
    }
    double each() const { return least_.back() / static_cast<double>(growing_.sizes.back()); }
    double least_of_smallest() const { return least_.front(); }

private:
    const Instance& instance_;
    const Growing& growing_;
    std::vector<double> least_;
    double spent_ = 0;
};

/// Measures until the growth is seen to be lawful, or long enough; tells it, and fails the check where it is not.
std::string judge_growth(const Growing& growing, Stopwatch& stopwatch) {
    const double first = stopwatch.once(growing.calls.front());
    double exponent = 0;
    for (int round = 0; round < rounds; ++round) {
        stopwatch.measure();
        exponent = stopwatch.exponent();
        if (exponent < growing.exponent_warned || stopwatch.spent() > time_enough) break;
    }
    const std::string told =
        fmt::format("{} takes time that grows as n^{:.2f} from {} to {} {}, expected n^{:g}", growing.function,
                    exponent, growing.sizes.front(), growing.sizes.back(), growing.what, growing.exponent_expected);
    if (exponent > growing.exponent_refused) FAIL(told);
    if (exponent > growing.exponent_warned) warn(told);
    return fmt::format("{}: {:.0f} ns each of the {}, time grows as n^{:.2f}, the first call {:.1f} times a later one",
                       growing.function, stopwatch.each() * 1e9, growing.what, exponent,
                       first / stopwatch.least_of_smallest());
}

}  // namespace

PELORUS_CHECK(model, "cost-linear-in-items", 5,
              "Twice the items take twice the time; what is quadratic in a thousand tracks misses the next scan. The "
              "cost of an item, of an empty call and of the first call are told.",
              {"numbers-finite"}) {
    for_batches(
        bench,
        [&](const Instance& instance, const HotCall& call) {
            Growing growing = linear(call.function, "items");
            const std::int64_t most = most_items(call);
            growing.sizes = {most / 8, most / 4, most / 2, most};
            for (const std::int64_t size : growing.sizes) {
                std::vector<std::int64_t> items(static_cast<std::size_t>(size));
                std::iota(items.begin(), items.end(), 0);
                growing.calls.push_back(call.of_items(items));
            }
            Stopwatch stopwatch(instance, growing);
            const std::string told = judge_growth(growing, stopwatch);
            double empty = 1e300;
            const HotCall none = call.of_items({});
            for (int repeat = 0; repeat < repeats; ++repeat) empty = std::min(empty, stopwatch.once(none));
            note(fmt::format("{}, an empty call takes {:.0f} % of an item", told, 100 * empty / stopwatch.each()));
        },
        linear("", "").sizes.back());
}

PELORUS_CHECK(trajectory, "cost-linear-in-times", 5,
              "Twice the times take twice the time; a path that begins anew for each of them makes a long run wait for "
              "its truth.",
              {"numbers-finite"}) {
    using namespace trajectory_calls;
    const auto instance = bench.make();
    Sample sample = bench.sample();
    const Argument record = realised(*instance, sample.key());
    Growing growing = linear("states", "times");
    const std::vector<std::int64_t> times = ascending_times(sample, growing.sizes.back(), 0.1);
    for (const std::int64_t size : growing.sizes)
        growing.calls.push_back(states(*instance, record, {times.begin(), times.begin() + size}, false));
    Stopwatch stopwatch(*instance, growing);
    note(judge_growth(growing, stopwatch));
}

PELORUS_CHECK(partitioner, "cost-of-pairs", 5,
              "Twice the points take four times the time at most, that of all pairs; what looks at all triples stands "
              "still in the first scan of clutter.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const PartitionerCalls calls(*instance);
    Sample sample = bench.sample();
    Growing growing{"split", "points", {64, 128, 256, 512}, {}, 2, 2.2, 2.5};
    for (const std::int64_t size : growing.sizes) {
        const ScanToSplit scan = sample_scan_to_split(calls.info.dimension_max, size, 0, sample);
        growing.calls.push_back(calls.split(scan, calls.needed(scan)));
    }
    Stopwatch stopwatch(*instance, growing);
    note(judge_growth(growing, stopwatch));
}

}  // namespace pelorus::conformance
