// Predict and update of 1000 nine-state tracks: through plugins, and by the same arithmetic written out in this program.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "inline/dense_filter.hpp"
#include "inline/track_filter.hpp"
#include "plugin_filter.hpp"

namespace pelorus::bench {

namespace {

constexpr std::size_t tracks = 1000;
constexpr double dt = 0.5, jerk = 0.5;  // s, m2/s5; as in configs/filter.yaml

/// The mount of the spherical sensor in configs/filter.yaml.
plain::Mount mount() {
    constexpr double degree = 3.14159265358979323846 / 180.0;
    const double cr = std::cos(2 * degree), sr = std::sin(2 * degree), cp = std::cos(-degree), sp = std::sin(-degree);
    const double cy = std::cos(30 * degree), sy = std::sin(30 * degree);
    return {{100.0, -50.0, 20.0},
            {cy * cp, sy * cp, -sp, cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr, cy * sp * cr + sy * sr,
             sy * sp * cr - cy * sr, cp * cr},
            {}};
}

/// Tracks of different places and covariances, and a measurement by each sensor near each.
struct Scenario {
    std::vector<plain::Track> start = std::vector<plain::Track>(tracks), predicted = start;
    std::vector<plain::Measurement> position = std::vector<plain::Measurement>(tracks), spherical = position;

    Scenario() {
        std::mt19937_64 engine(5);  // its numbers are the same everywhere; those of the distributions need not be
        const auto within = [&](double low, double high) {
            return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
        };
        const plain::Mount stand = mount();
        for (std::size_t i = 0; i < tracks; ++i) {
            const double mean[9] = {within(2e3, 2e4),  within(-1e4, 1e4), within(500, 5e3),
                                    within(-200, 200), within(-200, 200), within(-20, 20),
                                    within(-5, 5),     within(-5, 5),     within(-1, 1)};
            std::copy_n(mean, 9, start[i].mean.begin());
            double factor[81];
            for (int e = 0; e < 81; ++e) factor[e] = within(-1, 1) * (e % 9 < 3 ? 20.0 : e % 9 < 6 ? 5.0 : 1.0);
            for (std::size_t c = 0; c < 9; ++c)
                for (std::size_t r = 0; r < 9; ++r) {
                    double sum = 0.0;
                    for (std::size_t k = 0; k < 9; ++k) sum += factor[k * 9 + r] * factor[k * 9 + c];
                    start[i].covariance[c * 9 + r] = sum;
                }
        }
        if (!plain::predict(start.data(), predicted.data(), tracks, dt, jerk))
            throw std::logic_error("the scenario is not finite");
        for (std::size_t i = 0; i < tracks; ++i) {
            double along[3] = {};
            for (std::size_t r = 0; r < 3; ++r) {
                position[i].value[r] = predicted[i].mean[r] + within(-10, 10);
                position[i].noise[4 * r] = 100.0;
                for (std::size_t k = 0; k < 3; ++k)
                    along[r] += stand.rotation[r * 3 + k] * (position[i].value[k] - stand.position[k]);
            }
            const double ground = std::sqrt(along[0] * along[0] + along[1] * along[1]);
            spherical[i].value = {std::sqrt(ground * ground + along[2] * along[2]), std::atan2(along[1], along[0]),
                                  std::atan2(along[2], ground)};
            spherical[i].noise = {100.0, 0, 0, 0, 1e-6, 0, 0, 0, 1e-6};
        }
    }
    const plain::Measurement* measurements(plain::Sensor sensor) const {
        return sensor == plain::Sensor::position ? position.data() : spherical.data();
    }
};

const Scenario& scenario() {
    static const Scenario made;
    return made;
}

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

double median(std::vector<double>& numbers) {
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

/// The median of the ratios of pairs of calls that follow each other at once, in both orders: what slows the machine down
/// for longer than a millisecond slows both of a pair.
template <class Step, class Reference>
void compare(benchmark::State& state, const Step& step, const Reference& reference) {
    using Clock = std::chrono::steady_clock;
    Answers answers, right;
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

void inline_predict(Answers& out) {
    if (!plain::predict(scenario().start.data(), out.track.data(), tracks, dt, jerk))
        throw std::runtime_error("the inline filter failed");
}

void inline_update(plain::Sensor sensor, Answers& out) {
    static const plain::Mount stand = mount();
    if (!plain::update(sensor, stand, scenario().predicted.data(), scenario().measurements(sensor), out.track.data(),
                       out.log_likelihood.data(), tracks))
        throw std::runtime_error("the inline filter failed");
}

PluginFilter& filter() {
    static PluginFilter made(tracks);
    return made;
}

void plugin_predict(Answers& out) {
    require(filter().predict(scenario().start.data(), out.track.data(), dt), filter());
}

void plugin_update(plain::Sensor sensor, Answers& out) {
    require(filter().update(sensor, scenario().predicted.data(), scenario().measurements(sensor), out.track.data(),
                            out.log_likelihood.data()),
            filter());
}

void dense_predict(Answers& out) { dense::predict(scenario().start.data(), out.track.data(), tracks, dt, jerk); }

void dense_update(Answers& out) {
    dense::update(scenario().predicted.data(), scenario().position.data(), out.track.data(), out.log_likelihood.data(),
                  tracks);
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
        compare(state, step, reference);
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
