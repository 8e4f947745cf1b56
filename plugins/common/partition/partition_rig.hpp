/// A partitioner asked in a test, and answers to hold it against that come from looking at all pairs.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <Eigen/Dense>

#include "../../../tests/support/airship_parts.hpp"
#include "request.hpp"

namespace partition {

struct Scene {
    Eigen::MatrixXd points;                   ///< d x M
    std::vector<Eigen::MatrixXd> covariance;  ///< of each point; one: common to all; none: not known
    Eigen::MatrixXd mean;                     ///< d x predictions
    std::vector<Eigen::MatrixXd> mean_covariance, extent;
};

struct CellSeen {
    std::int64_t prediction = -1;
    std::vector<std::int64_t> points;
    std::vector<double> weights;
};
using CellsSeen = std::vector<CellSeen>;

class PartitionerUnderTest {
public:
    explicit PartitionerUnderTest(const std::string& name, const std::string& with = "{}")
        : plugin_(test_support::plugin("partitioner", name)), instance_(bench_, plugin_, with) {
        raw_.struct_size = sizeof raw_;
        raw_.slot = raw_.name = raw_.address = "";
        raw_.table_id = plugin_.table_id;
        raw_.description = plugin_.description;
        raw_.instance = {instance_.self(), &instance_.table<plr_partitioner>().head};
        part_ = pelorus::PartitionerPart(raw_);
    }

    plr_status try_split(const Scene& scene, const plr_parallel* parallel = nullptr) {
        const std::int64_t d = scene.points.rows();
        const auto stacked = [d](const std::vector<Eigen::MatrixXd>& all) {
            std::vector<double> numbers;
            for (const auto& one : all) numbers.insert(numbers.end(), one.data(), one.data() + d * d);
            return numbers;
        };
        const std::vector<double> covariance = stacked(scene.covariance), of_mean = stacked(scene.mean_covariance),
                                  extent = stacked(scene.extent);
        std::vector<std::uint64_t> ids(static_cast<std::size_t>(scene.mean.cols()));
        std::iota(ids.begin(), ids.end(), 1);
        const auto count = static_cast<std::int64_t>(ids.size());
        auto args = pelorus::arguments<plr_partitioner_split>();
        args.points = pelorus::const_view(scene.points.data(), d, 1, scene.points.cols());
        if (scene.covariance.size() == 1)
            args.covariance = pelorus::common_view(covariance.data(), d, d, scene.points.cols());
        else if (!scene.covariance.empty())
            args.covariance = pelorus::const_view(covariance.data(), d, d, scene.points.cols());
        args.predictions.count = count;
        args.predictions.ids = ids.data();
        args.predictions.mean = pelorus::const_view(scene.mean.data(), d, 1, count);
        args.predictions.covariance = pelorus::const_view(of_mean.data(), d, d, count);
        if (!extent.empty()) args.predictions.extent = pelorus::const_view(extent.data(), d, d, count);
        args.parallel = parallel;
        test_support_call_.raw().keys = &key;
        test_support_call_.clear();
        return request_.split(part_, test_support_call_.raw(), args);
    }
    /// The alternatives of a scan, each its cells.
    std::vector<CellsSeen> split_all(const Scene& scene, const plr_parallel* parallel = nullptr) {
        const plr_status status = try_split(scene, parallel);
        INFO(message());
        REQUIRE(status == PLR_OK);
        std::vector<CellsSeen> all;
        for (std::int64_t a = 0; a < request_.alternatives(); ++a) {
            all.emplace_back();
            for (std::int64_t c = request_.first_cell(a); c < request_.first_cell(a + 1); ++c)
                all.back().push_back({request_.prediction(c),
                                      {request_.points(c), request_.points(c) + request_.size(c)},
                                      {request_.weights(c), request_.weights(c) + request_.size(c)}});
        }
        return all;
    }
    /// Its only alternative; none for no points.
    CellsSeen split(const Scene& scene, const plr_parallel* parallel = nullptr) {
        const auto all = split_all(scene, parallel);
        REQUIRE(all.size() == (scene.points.cols() == 0 ? 0u : 1u));
        return all.empty() ? CellsSeen{} : all.front();
    }
    double weight(std::int64_t alternative) const { return request_.weight(alternative); }
    std::string message() const { return test_support_call_.message(); }

    plr_key key{{1, 2}};

private:
    /// The context of a call; its error can be cleared.
    class CallContext : public test_support::Call {
    public:
        void clear() { raw().error->code = PLR_OK, raw().error->message[0] = 0; }
    };

    test_support::Bench bench_;
    const plr_plugin& plugin_;
    test_support::BenchInstance instance_;
    plr_part raw_{};
    pelorus::PartitionerPart part_;
    CallContext test_support_call_;
    Request request_;
};

/// The first member of each point's cell, for a partition without overlap.
inline std::vector<std::int64_t> first_members(const CellsSeen& cells, Eigen::Index points) {
    std::vector<std::int64_t> first(static_cast<std::size_t>(points), -1);
    for (const CellSeen& cell : cells)
        for (const std::int64_t point : cell.points) first[static_cast<std::size_t>(point)] = cell.points.front();
    return first;
}

/// The same, of the connected components of all pairs (i, j) for which linked(i, j): every pair is looked at.
template <class Linked> std::vector<std::int64_t> components_by_pairs(Eigen::Index points, const Linked& linked) {
    std::vector<std::int64_t> first(static_cast<std::size_t>(points));
    std::iota(first.begin(), first.end(), 0);
    const auto root = [&](std::int64_t i) {
        while (first[static_cast<std::size_t>(i)] != i) i = first[static_cast<std::size_t>(i)];
        return i;
    };
    for (Eigen::Index j = 1; j < points; ++j)
        for (Eigen::Index i = 0; i < j; ++i) {
            if (!linked(i, j)) continue;
            const std::int64_t a = root(i), b = root(j);
            first[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
        }
    for (std::int64_t& one : first) one = root(one);
    return first;
}

/// |a - b|^2 as the partitioners sum it.
inline double squared_distance(const Eigen::MatrixXd& points, Eigen::Index a, Eigen::Index b) {
    double sum = 0;
    for (Eigen::Index axis = 0; axis < points.rows(); ++axis)
        sum += (points(axis, a) - points(axis, b)) * (points(axis, a) - points(axis, b));
    return sum;
}

/// Where points lie, in units of a length.
enum class Pattern {
    uniform,
    clumps,
    ball,
    half_lattice,
    lattice,
    diagonal_lattice,
    all_scales,
    facing_clouds,
    facing_lines
};
constexpr Pattern all_patterns[] = {Pattern::uniform,      Pattern::clumps,        Pattern::ball,
                                    Pattern::half_lattice, Pattern::lattice,       Pattern::diagonal_lattice,
                                    Pattern::all_scales,   Pattern::facing_clouds, Pattern::facing_lines};

/// `count` points with about three others within `length` of each (uniform, lattices), or many, on both sides of the origin.
inline Eigen::MatrixXd pattern(Pattern which, int dimension, Eigen::Index count, double length,
                               std::mt19937_64& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    std::normal_distribution<double> normal;
    const double ball = dimension == 1 ? 2 : dimension == 2 ? 3.14159 : 4.18879;
    const double side = length * std::pow(ball * static_cast<double>(count) / 3, 1.0 / dimension);
    Eigen::MatrixXd points(dimension, count), centres(dimension, count / 100 + 1);
    for (double& x : centres.reshaped()) x = (uniform(random) - 0.5) * side;
    for (Eigen::Index i = 0; i < count; ++i) {
        const double along = uniform(random);
        for (int axis = 0; axis < dimension; ++axis) {
            double& x = points(axis, i);
            const double anywhere = (uniform(random) - 0.5) * side;
            const auto on_lattice = [&](double step) { return step * std::floor(anywhere / step); };
            switch (which) {
                case Pattern::uniform:
                    x = anywhere;
                    break;
                case Pattern::clumps:
                    x = centres(axis, i % centres.cols()) + length * normal(random);
                    break;
                case Pattern::ball:
                    x = 0.1 * length * normal(random);
                    break;
                case Pattern::half_lattice:
                    x = on_lattice(length / 2);
                    break;
                case Pattern::lattice:
                    x = on_lattice(length);
                    break;
                case Pattern::diagonal_lattice:
                    x = on_lattice(length / std::sqrt(dimension));
                    break;
                case Pattern::all_scales:
                    x = anywhere * std::pow(10, 40 * uniform(random));
                    break;
                case Pattern::facing_clouds:
                    x = 0.3 * length * uniform(random) + (axis == 0 && i % 2 == 0 ? 1.2 * length : 0);
                    break;
                case Pattern::facing_lines:
                    x = 0.7 * length * along + (i % 2 == 0 && axis < 2 ? (axis == 0 ? 0.7072 : -0.7072) * length : 0);
                    break;
            }
        }
    }
    return points;
}

}  // namespace partition
