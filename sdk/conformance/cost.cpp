// What a call costs, and how that grows.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "model_calls.hpp"

namespace pelorus::conformance {

namespace {

constexpr std::int64_t sizes[] = {512, 1024, 2048, 4096};
/// Twice the items may take 2^1.2 times as long without a word (caches), 2^1.5 times with a warning. n log n is below both.
constexpr double exponent_warned = 1.2, exponent_refused = 1.5;
constexpr int repeats = 5, rounds = 6;
/// Of rounds, in s: what is quadratic stays so, and a library has many calls and subjects.
constexpr double time_enough = 0.5;

class Stopwatch {
public:
    Stopwatch(const Instance& instance, const HotCall& largest) : instance_(instance) {
        for (const std::int64_t size : sizes) {
            std::vector<std::int64_t> items(static_cast<std::size_t>(size));
            for (std::size_t i = 0; i < items.size(); ++i) items[i] = static_cast<std::int64_t>(i);
            calls_.push_back(largest.of_items(items));
            least_.push_back(1e300);
        }
    }
    /// Least times so far, of some more repeats.
    void measure() {
        for (int repeat = 0; repeat < repeats; ++repeat)
            for (std::size_t k = 0; k < calls_.size(); ++k) {
                const double seconds = once(calls_[k]);
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
    /// The slope of log time over log items, by least squares.
    double exponent() const {
        double x = 0, y = 0, xx = 0, xy = 0;
        const double n = static_cast<double>(least_.size());
        for (std::size_t k = 0; k < least_.size(); ++k) {
            const double u = std::log(static_cast<double>(sizes[k])), v = std::log(least_[k]);
            x += u, y += v, xx += u * u, xy += u * v;
        }
        return (n * xy - x * y) / (n * xx - x * x);
    }
    double an_item() const { return least_.back() / static_cast<double>(sizes[least_.size() - 1]); }
    const HotCall& smallest() const { return calls_.front(); }
    double least_of_smallest() const { return least_.front(); }

private:
    const Instance& instance_;
    std::vector<HotCall> calls_;
    std::vector<double> least_;
    double spent_ = 0;
};

}  // namespace

PELORUS_CHECK(model, "cost-linear-in-items", 5,
              "Twice the items take twice the time; what is quadratic in a thousand tracks misses the next scan. The "
              "cost of an item, of an empty call and of the first call are told.",
              {"numbers-finite"}) {
    for_batches(
        bench,
        [&](const Instance& instance, const HotCall& call) {
            Stopwatch stopwatch(instance, call);
            const double first = stopwatch.once(stopwatch.smallest());
            double exponent = 0;
            for (int round = 0; round < rounds; ++round) {
                stopwatch.measure();
                exponent = stopwatch.exponent();
                if (exponent < exponent_warned || stopwatch.spent() > time_enough) break;
            }
            double empty = 1e300;
            const HotCall none = call.of_items({});
            for (int repeat = 0; repeat < repeats; ++repeat) empty = std::min(empty, stopwatch.once(none));
            note(
                fmt::format("{}: {:.0f} ns an item, time grows as n^{:.2f}, an empty call takes {:.0f} % of an item, "
                            "the first call {:.1f} times a later one",
                            call.function, stopwatch.an_item() * 1e9, exponent, 100 * empty / stopwatch.an_item(),
                            first / stopwatch.least_of_smallest()));
            const std::string told = fmt::format(
                "{} takes time that grows as n^{:.2f} from {} to {} items, expected "
                "n^1",
                call.function, exponent, sizes[0], sizes[std::size(sizes) - 1]);
            if (exponent > exponent_refused) FAIL(told);
            if (exponent > exponent_warned) warn(told);
        },
        sizes[std::size(sizes) - 1]);
}

}  // namespace pelorus::conformance
