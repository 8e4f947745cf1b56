/// Times of two calls, set against each other.
#pragma once

#include <algorithm>
#include <chrono>
#include <exception>
#include <vector>

#include <benchmark/benchmark.h>

namespace pelorus::bench {

inline double median(std::vector<double>& numbers) {
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

/// The median of the ratios step / reference of pairs of calls that follow each other at once, in both orders: what slows the
/// machine down for longer than a millisecond slows both of a pair. Each call gets answers of its own to fill.
template <class Answers, class Step, class Reference>
void compare(benchmark::State& state, Answers answers, const Step& step, const Reference& reference) {
    using Clock = std::chrono::steady_clock;
    Answers right = answers;
    std::vector<double> ratios;
    const auto seconds_of = [](const auto& call, Answers& out) {
        const auto start = Clock::now();
        call(out);
        benchmark::ClobberMemory();
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    try {
        bool turned = false;
        for (auto _ : state) {
            const double first = turned ? seconds_of(reference, right) : seconds_of(step, answers);
            const double second = turned ? seconds_of(step, answers) : seconds_of(reference, right);
            ratios.push_back(turned ? second / first : first / second);
            turned = !turned;
        }
    } catch (const std::exception& problem) {
        state.SkipWithError(problem.what());
        return;
    }
    state.counters["ratio"] = median(ratios);
}

}  // namespace pelorus::bench
