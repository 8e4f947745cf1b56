// A step (predict and update) of 1000 tracks: by the plugin, by dense matrices, by the plugin's kernels alone, and what moving
// the records costs.
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "../plugins/estimator/kalman/kalman_kernels.hpp"
#include "compare.hpp"
#include "inline/dense_filter.hpp"
#include "plugin_filter.hpp"
#include "scenario.hpp"

namespace pelorus::bench {

namespace {

/// Records after a step, and the likelihoods of its measurements.
struct Answers {
    std::vector<double> record;
    std::vector<double> log_likelihood = std::vector<double>(tracks);
};

template <int B> struct Tracks {
    static constexpr int n = 3 * B, size = n + n * n;

    static const std::vector<double>& start() {
        static const std::vector<double> made = scenario().leading(n);
        return made;
    }
    /// A filter and its records of the tracks at the start.
    struct Filter {
        Filter(const std::string& estimator, const std::string& form)
            : plugin(tracks, n, estimator, form), records(start().size()) {
            if (!plugin.assign(start().data(), records.data())) throw std::runtime_error(plugin.failure());
        }
        PluginFilter plugin;
        std::vector<double> records;
    };

    /// The step by an estimator that keeps records of this size.
    static void by(const std::string& estimator, plain::Sensor sensor, Answers& out, const std::string& form = {}) {
        static std::map<std::string, std::unique_ptr<Filter>> made;  // when first asked for: loading takes a while
        auto& filter = made[estimator + form];
        if (filter == nullptr) filter = std::make_unique<Filter>(estimator, form);
        double* const record = out.record.data();
        if (!filter->plugin.predict(filter->records.data(), record, dt) ||
            !filter->plugin.update(sensor, record, scenario().measurements(sensor), record, out.log_likelihood.data()))
            throw std::runtime_error("the filter failed: " + filter->plugin.failure());
    }

    static void dense(plain::Sensor sensor, Answers& out) {
        double* const record = out.record.data();
        dense::predict<B>(start().data(), record, tracks, dt, density);
        dense::update<B>(sensor, mount(), record, scenario().measurements(sensor), record, out.log_likelihood.data(),
                         tracks);
    }

    /// The arithmetic of the plugin for a position sensor, and nothing else: no ABI, no part is asked, blocks stay in the
    /// nearest cache from prediction to update.
    static void kernels(Answers& out) {
        using namespace kalman;
        static const Kernels& all = kalman::kernels(lanes::best_instruction_set());
        static const BlockKernel predict = all.by_blocks(B, 3);
        static const auto update = all.measurement(n, 3, 3).update;
        constexpr double h[3 * n] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        static const Model model;
        for (int first = 0; first < static_cast<int>(tracks); first += block_items) {
            const int items = std::min(block_items, static_cast<int>(tracks) - first);
            Outcome outcome[block_items] = {};
            double* const record = out.record.data() + first * size;
            predict({B,
                     3,
                     true,
                     true,
                     items,
                     model.f1,
                     model.q1,
                     {start().data() + first * size, size},
                     {record, size},
                     outcome});
            double innovation[block_items * 3];
            const plain::Measurement* const z = scenario().position.data() + first;
            for (int i = 0; i < items; ++i)
                for (int r = 0; r < 3; ++r)
                    innovation[i * 3 + r] = z[i].value[static_cast<std::size_t>(r)] - record[i * size + r];
            update({n,
                    3,
                    3,
                    items,
                    {record, size},
                    {h, 0},
                    {z->noise.data(), 12},
                    {innovation, 3},
                    {record, size},
                    {out.log_likelihood.data() + first, 1},
                    {nullptr, 0},
                    outcome});
            for (const Outcome each : outcome)
                if (each != Outcome::done) throw std::runtime_error("the kernels failed");
        }
    }

    /// Every record read and written twice, as prediction and update do.
    static void copies(Answers& out) {
        static std::vector<double> between(start().size());
        std::memcpy(between.data(), start().data(), between.size() * sizeof(double));
        benchmark::DoNotOptimize(between.data());
        benchmark::ClobberMemory();
        std::memcpy(out.record.data(), between.data(), between.size() * sizeof(double));
    }

private:
    /// F1 and Q1 beside each other for each item of a block.
    struct Model {
        double f1[B * B * kalman::block_items], q1[B * B * kalman::block_items];
        Model() {
            for (int c = 0; c < B; ++c) {
                for (int r = 0; r < B; ++r) {
                    const int left = B - 1 - r, right = B - 1 - c;  // derivatives below the noisy one
                    double f = 0.0, q = density * std::pow(dt, left + right + 1) / (left + right + 1);
                    for (int k = 2; k <= left; ++k) q /= k;
                    for (int k = 2; k <= right; ++k) q /= k;
                    if (c >= r) f = std::pow(dt, c - r);
                    for (int k = 2; k <= c - r; ++k) f /= k;
                    for (int i = 0; i < kalman::block_items; ++i) {
                        f1[(c * B + r) * kalman::block_items + i] = f;
                        q1[(c * B + r) * kalman::block_items + i] = q;
                    }
                }
            }
        }
    };
};

/// Throws unless both have the same numbers, to `tolerance` of the largest of their kind.
void expect_same(int n, const Answers& one, const Answers& other, double tolerance) {
    const auto size = static_cast<std::size_t>(n + n * n);
    for (std::size_t i = 0; i < tracks; ++i) {
        const double *const a = one.record.data() + i * size, *const b = other.record.data() + i * size;
        bool same = std::fabs(one.log_likelihood[i] - other.log_likelihood[i]) <=
                    tolerance * (1.0 + std::fabs(other.log_likelihood[i]));
        for (int c = 0; c < n; ++c) {
            same = same && std::fabs(a[c] - b[c]) <= tolerance * (1.0 + std::fabs(b[c]));
            for (int r = 0; r < n; ++r) {
                const double scale = std::sqrt(b[n + c * (n + 1)] * b[n + r * (n + 1)]);
                same = same && std::fabs(a[n + c * n + r] - b[n + c * n + r]) <= tolerance * scale;
            }
        }
        if (!same) throw std::runtime_error("the two filters: different numbers at track " + std::to_string(i));
    }
}

template <int B> Answers blank() { return {std::vector<double>(Tracks<B>::start().size())}; }

template <int B, class Step> void add(const std::string& name, const Step& step) {
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        Answers answers = blank<B>();
        for (auto _ : state) {
            step(answers);
            benchmark::ClobberMemory();
        }
        state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(tracks));
    })->Unit(benchmark::kMicrosecond);
}

/// The ratio step / reference, once the two have been seen to give the same numbers, to a tolerance, if they should.
template <int B, class Step, class Reference>
void add_ratio(const std::string& name, const Step& step, const Reference& reference,
               std::optional<double> tolerance = 1e-8) {
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
        try {
            Answers one = blank<B>(), other = blank<B>();
            step(one);
            reference(other);
            if (tolerance) expect_same(3 * B, one, other, *tolerance);
        } catch (const std::exception& problem) {
            state.SkipWithError(problem.what());
            return;
        }
        compare(state, blank<B>(), step, reference);
    })->Unit(benchmark::kMicrosecond);
}

template <int B> void add_all() {
    const std::string states = "step/" + std::to_string(3 * B) + "_states/";
    for (const plain::Sensor sensor : {plain::Sensor::position, plain::Sensor::spherical}) {
        const std::string name = states + (sensor == plain::Sensor::position ? "position/" : "spherical/");
        const auto plugin = [sensor](Answers& out) { Tracks<B>::by("estimator.kalman", sensor, out); };
        const auto dense = [sensor](Answers& out) { Tracks<B>::dense(sensor, out); };
        add<B>(name + "plugin", plugin);
        add<B>(name + "dense", dense);
        add_ratio<B>(name + "dense_to_plugin", dense, plugin);
        if (sensor == plain::Sensor::spherical) {
            const auto roots = [sensor](Answers& out) {
                Tracks<B>::by("estimator.kalman", sensor, out, "square_root");
            };
            add<B>(name + "square_root", roots);
            add_ratio<B>(name + "square_root_to_plugin", roots, plugin, std::nullopt);
            for (const std::string rule : {"cubature", "unscented", "gauss_hermite"}) {
                if (B == 3 && rule == "gauss_hermite") continue;  // 3^9 points are refused
                const auto points = [sensor, rule](Answers& out) { Tracks<B>::by("estimator." + rule, sensor, out); };
                add<B>(name + rule, points);
                add_ratio<B>(name + rule + "_to_plugin", points, plugin, std::nullopt);
            }
            continue;
        }
        add<B>(name + "kernels", &Tracks<B>::kernels);
        add<B>(name + "copies", &Tracks<B>::copies);
        add_ratio<B>(name + "plugin_to_kernels", plugin, &Tracks<B>::kernels);
    }
}

[[maybe_unused]] const bool registered = [] {
    add_all<2>();
    add_all<3>();
    return true;
}();

}  // namespace

}  // namespace pelorus::bench
