// Predict and update of 1000 nine-state tracks: through plugins, and by the same arithmetic written out in this program.
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "compare.hpp"
#include "inline/dense_filter.hpp"
#include "inline/track_filter.hpp"
#include "plugin_filter.hpp"
#include "scenario.hpp"

namespace pelorus::bench {

namespace {

/// Everything that a filter answers for the scenario.
struct Answers {
    std::vector<plain::Track> track = std::vector<plain::Track>(tracks);
    std::vector<double> log_likelihood = std::vector<double>(tracks);
};

/// Throws unless both have the same numbers, to `tolerance` of the largest of their kind.
void expect_same(const Answers& one, const Answers& other, double tolerance, const std::string& what) {
    for (std::size_t i = 0; i < tracks; ++i) {
        for (std::size_t c = 0; c < 9; ++c) {
            const double largest = 1.0 + std::fabs(other.track[i].mean[c]);
            bool same = std::fabs(one.track[i].mean[c] - other.track[i].mean[c]) <= tolerance * largest;
            for (std::size_t r = 0; r < 9; ++r) {
                const double scale = std::sqrt(other.track[i].covariance[c * 10] * other.track[i].covariance[r * 10]);
                same = same && std::fabs(one.track[i].covariance[c * 9 + r] - other.track[i].covariance[c * 9 + r]) <=
                                   tolerance * scale;
            }
            same = same && std::fabs(one.log_likelihood[i] - other.log_likelihood[i]) <=
                               tolerance * (1.0 + std::fabs(other.log_likelihood[i]));
            if (!same) throw std::runtime_error(what + ": different numbers at track " + std::to_string(i));
        }
    }
}

void require(bool good, const PluginFilter& filter) {
    if (!good) throw std::runtime_error("the filter failed: " + filter.failure());
}

/// Measures `step`, which fills its answers, once it has been seen to give what `expected` gives.
template <class Step, class Expected>
void measure(benchmark::State& state, const Step& step, const Expected& expected, double tolerance) {
    Answers answers;
    try {
        Answers right;
        step(answers);
        expected(right);
        expect_same(answers, right, tolerance, "the two filters");
        for (auto _ : state) {
            step(answers);
            benchmark::DoNotOptimize(answers.track.data());
            benchmark::ClobberMemory();
        }
    } catch (const std::exception& problem) {
        state.SkipWithError(problem.what());
        return;
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(tracks));
}

void inline_predict(Answers& out) {
    if (!plain::predict(scenario().start.data(), out.track.data(), tracks, dt, density))
        throw std::runtime_error("the inline filter failed");
}

void inline_update(plain::Sensor sensor, Answers& out) {
    if (!plain::update(sensor, mount(), scenario().predicted.data(), scenario().measurements(sensor), out.track.data(),
                       out.log_likelihood.data(), tracks))
        throw std::runtime_error("the inline filter failed");
}

const double* numbers_of(const std::vector<plain::Track>& track) { return track.front().mean.data(); }
double* numbers_of(std::vector<plain::Track>& track) { return track.front().mean.data(); }

PluginFilter& filter() {
    static PluginFilter made(tracks, plain::states);
    return made;
}

void plugin_predict(Answers& out) {
    require(filter().predict(numbers_of(scenario().start), numbers_of(out.track), dt), filter());
}

void plugin_update(plain::Sensor sensor, Answers& out) {
    require(filter().update(sensor, numbers_of(scenario().predicted), scenario().measurements(sensor),
                            numbers_of(out.track), out.log_likelihood.data()),
            filter());
}

void dense_predict(Answers& out) {
    dense::predict<3>(numbers_of(scenario().start), numbers_of(out.track), tracks, dt, density);
}

void dense_update(Answers& out) {
    dense::update<3>(plain::Sensor::position, mount(), numbers_of(scenario().predicted), scenario().position.data(),
                     numbers_of(out.track), out.log_likelihood.data(), tracks);
}

// The same operations in another order of addition: a few roundings of numbers of this size.
constexpr double roundings = 1e-12;
// Another form of the update: what that loses by itself.
constexpr double other_form = 1e-8;

const auto position_update = [](auto update) {
    return [update](Answers& out) { update(plain::Sensor::position, out); };
};
const auto spherical_update = [](auto update) {
    return [update](Answers& out) { update(plain::Sensor::spherical, out); };
};

template <class Step, class Expected>
void add(const char* name, const Step& step, const Expected& expected, double tolerance) {
    benchmark::RegisterBenchmark(name, [=](benchmark::State& state) {
        measure(state, step, expected, tolerance);
    })->Unit(benchmark::kMicrosecond);
}

template <class Step, class Reference> void add_ratio(const char* name, const Step& step, const Reference& reference) {
    benchmark::RegisterBenchmark(name, [=](benchmark::State& state) {
        compare(state, Answers(), step, reference);
    })->Unit(benchmark::kMicrosecond);
}

[[maybe_unused]] const bool registered = [] {
    add("filter/predict/plugin", plugin_predict, inline_predict, roundings);
    add("filter/predict/inline", inline_predict, plugin_predict, roundings);
    add("filter/predict/dense", dense_predict, inline_predict, roundings);
    add("filter/update_position/plugin", position_update(plugin_update), position_update(inline_update), roundings);
    add("filter/update_position/inline", position_update(inline_update), position_update(plugin_update), roundings);
    add("filter/update_position/dense", dense_update, position_update(inline_update), other_form);
    add("filter/update_spherical/plugin", spherical_update(plugin_update), spherical_update(inline_update), roundings);
    add("filter/update_spherical/inline", spherical_update(inline_update), spherical_update(plugin_update), roundings);
    add_ratio("filter/predict/ratio", plugin_predict, inline_predict);
    add_ratio("filter/update_position/ratio", position_update(plugin_update), position_update(inline_update));
    add_ratio("filter/update_spherical/ratio", spherical_update(plugin_update), spherical_update(inline_update));
    return true;
}();

}  // namespace

}  // namespace pelorus::bench
