// The distance partition of scans of a thousand to a million points: by the plugin, and by a k-d tree with union-find.
#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <nanoflann.hpp>

#include "../plugins/common/partition/request.hpp"
#include "../tests/support/plugin_instance.hpp"

namespace pelorus::bench {

namespace {

constexpr int axes = 3;
constexpr double threshold = 1;  // m

/// One scan, points one behind the other.
using Scan = std::vector<double>;

/// Three points within the threshold of each, on average; clumps of a thousand with the threshold as deviation; or all
/// points within the threshold.
Scan scan(const std::string& kind, std::size_t count, std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    const double side = threshold * std::cbrt(4 * 3.14159 / 3 * static_cast<double>(count) / 3);
    Scan out(axes * count), centres(axes * (count / 1000 + 1));
    for (double& x : centres) x = side * uniform(random);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t clump = i / axes % (centres.size() / axes), axis = i % axes;
        out[i] = kind == "uniform"   ? side * uniform(random)
                 : kind == "clumped" ? centres[axes * clump + axis] + threshold * normal(random)
                                     : threshold * uniform(random) / std::sqrt(3.0);
    }
    return out;
}

/// As many scans as make a hundred thousand points, so that no branch is learnt by heart.
std::vector<Scan> scans(const std::string& kind, std::size_t count) {
    std::mt19937_64 random(count);
    std::vector<Scan> out;
    for (std::size_t k = 0; k < std::max<std::size_t>(1, 100000 / count); ++k) out.push_back(scan(kind, count, random));
    return out;
}

/// Cells as the first member of each point's.
using Cells = std::vector<std::int64_t>;

class PluginPartition {
public:
    void operator()(const Scan& scan) {
        auto args = arguments<plr_partitioner_split>();
        args.points = const_view(scan.data(), axes, 1, static_cast<std::int64_t>(scan.size()) / axes);
        if (request_.split(part_, call_, args) != PLR_OK) throw std::runtime_error(call_.message());
    }
    Cells cells(const Scan& scan) {
        (*this)(scan);
        Cells out(scan.size() / axes);
        for (std::int64_t cell = 0; cell < request_.cells(); ++cell)
            for (std::int64_t k = 0; k < request_.size(cell); ++k)
                out[static_cast<std::size_t>(request_.points(cell)[k])] = request_.points(cell)[0];
        return out;
    }

private:
    test_support::Instance instance_{"partitioner", "distance", {{"threshold", std::to_string(threshold)}}};
    PartitionerPart part_ = instance_.as<PartitionerPart>();
    test_support::Call call_;
    partition::Request request_;
};

/// A k-d tree, the neighbours of each point within the radius, and union-find.
class TreePartition {
public:
    void operator()(const Scan& scan) { cells(scan); }
    Cells cells(const Scan& scan) {
        const Cloud cloud{scan};
        Tree tree(axes, cloud, {10});
        Cells parent(scan.size() / axes);
        std::iota(parent.begin(), parent.end(), 0);
        const auto root = [&](std::int64_t i) {
            while (at(parent, i) != i) i = at(parent, i) = at(parent, at(parent, i));
            return i;
        };
        for (std::size_t i = 0; i < parent.size(); ++i) {
            tree.radiusSearch(scan.data() + axes * i, threshold * threshold, near_,
                              nanoflann::SearchParams(32, 0, false));
            for (const auto& [j, square] : near_) {
                const std::int64_t a = root(static_cast<std::int64_t>(i)), b = root(static_cast<std::int64_t>(j));
                at(parent, std::max(a, b)) = std::min(a, b);
            }
        }
        for (std::int64_t& one : parent) one = root(one);
        return parent;
    }

private:
    struct Cloud {
        const Scan& scan;
        std::size_t kdtree_get_point_count() const { return scan.size() / axes; }
        double kdtree_get_pt(std::size_t i, std::size_t axis) const { return scan[axes * i + axis]; }
        template <class Box> bool kdtree_get_bbox(Box&) const { return false; }
    };
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, axes>;

    static std::int64_t& at(Cells& cells, std::int64_t i) { return cells[static_cast<std::size_t>(i)]; }
    std::vector<std::pair<std::uint32_t, double>> near_;
};

/// Measures one of the two, once both have been seen to answer the same.
template <class Measured, class Other> void measure(benchmark::State& state, const std::string& kind, bool compares) {
    try {
        const std::vector<Scan> all = scans(kind, static_cast<std::size_t>(state.range(0)));
        Measured measured;
        if (compares && measured.cells(all[0]) != Other().cells(all[0]))
            throw std::runtime_error("the two partitions are different");
        measured(all[0]);  // buffers grow to what they need, which a holder pays once
        std::size_t next = 0;
        for (auto _ : state) {
            measured(all[next]);
            next = (next + 1) % all.size();
        }
    } catch (const std::exception& problem) {
        state.SkipWithError(problem.what());
    }
    state.SetItemsProcessed(state.iterations() * state.range(0));
}

[[maybe_unused]] const bool registered = [] {
    for (const std::string kind : {"uniform", "clumped", "ball"}) {
        // All pairs of points in one ball are neighbours: a tree looks at each.
        const int most_of_tree = kind == "ball" ? 10000 : 100000;
        for (int count = 1000; count <= 1000000; count *= 10) {
            const bool compares = count <= most_of_tree;
            auto* const own = benchmark::RegisterBenchmark(
                ("partition/" + kind + "/plugin").c_str(),
                [=](benchmark::State& state) { measure<PluginPartition, TreePartition>(state, kind, compares); });
            own->Arg(count)->Unit(benchmark::kMillisecond);
            if (count > 100000) own->Repetitions(5);
            if (!compares) continue;
            auto* const tree = benchmark::RegisterBenchmark(
                ("partition/" + kind + "/nanoflann").c_str(),
                [=](benchmark::State& state) { measure<TreePartition, PluginPartition>(state, kind, true); });
            tree->Arg(count)->Unit(benchmark::kMillisecond);
            if (count >= most_of_tree) tree->Repetitions(5);
        }
    }
    return true;
}();

}  // namespace

}  // namespace pelorus::bench
