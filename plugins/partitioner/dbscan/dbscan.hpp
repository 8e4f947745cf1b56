/// partitioner.dbscan: clusters by density, and noise. See README.md.
#pragma once

#include "../../common/partition/writer.hpp"
#include "density_clusters.hpp"

namespace dbscan {

class Dbscan : public pelorus::Partitioner<Dbscan> {
public:
    static void describe(pelorus::Describe<Dbscan>& plugin) {
        plugin.title("Clusters by density (DBSCAN)")
            .purpose(
                "Measurements in dense surroundings that a chain of short steps joins are one cell, with those on "
                "their border; all others are noise, each a cell of its own. What the tracker predicts is not "
                "looked at.")
            .equation(
                "core: at least min_points points with |z_i - z_j| <= epsilon, itself counted; clusters: core points "
                "joined by steps of at most epsilon, and points within epsilon of one")
            .source(
                "M. Ester, H.-P. Kriegel, J. Sander, X. Xu, A Density-Based Algorithm for Discovering Clusters in "
                "Large Spatial Databases with Noise, KDD 1996, 226-231");
        plugin.parameter("epsilon", &Dbscan::epsilon_)
            .unit("m")
            .min(1e-9)
            .max(1e15)
            .doc("radius of the surroundings of a point");
        plugin.parameter("min_points", &Dbscan::min_points_)
            .initially("4")
            .min(1)
            .max(1e6)
            .doc("points in the surroundings of a core point, itself counted");
        plugin.parameter("border", &Dbscan::border_)
            .initially("nearest")
            .choices({{"nearest", "the cluster of the nearest core point, whatever the order of the points"},
                      {"first", "as published: the cluster whose first core point comes first in the scan"}})
            .doc("which cluster has a point that borders on several");
    }

    void setup(const pelorus::Setup&) {
        info.dimension_min = 1;
        info.dimension_max = 3;
        partition::tell(need(), info);
    }

    plr_status split(const plr_call& call, const plr_partitioner_split& args) const {
        partition::expect_points(info, args);
        partition::Writer writer(*args.out);
        const auto count = static_cast<std::uint32_t>(args.points.count);
        if (count > 0) {
            partition::CallMemory call_memory(call, need(), args.points.count);
            Memory& memory = call_memory;
            auto* const label = memory.take<std::uint32_t>(count);
            partition::by_dimension(args.points.rows, [&](auto dimension) {
                DensityClusters<decltype(dimension)::value>(memory, args.points, epsilon_, min_points_, border_,
                                                            args.parallel, call.error)
                    .labels(label);
            });
            writer.cells(Groups(memory, count, [label](std::uint32_t i) { return label[i]; }));
            writer.alternative(1);
        }
        return writer.finish();
    }

private:
    static constexpr Need need() noexcept {
        return partition::array<std::uint32_t>() + DensityClusters<3>::need() + Groups::need();
    }

    double epsilon_ = 0;
    std::uint32_t min_points_ = 0;
    Border border_ = Border::nearest;
};

}  // namespace dbscan
