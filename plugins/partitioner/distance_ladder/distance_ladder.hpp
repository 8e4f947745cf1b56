/// partitioner.distance_ladder: partitions by a ladder of distances, as alternatives. See README.md.
#pragma once

#include <vector>

#include "../../common/partition/distance_groups.hpp"
#include "../../common/partition/writer.hpp"

namespace distance_ladder {

class DistanceLadder : public pelorus::Partitioner<DistanceLadder> {
public:
    static void describe(pelorus::Describe<DistanceLadder>& plugin) {
        plugin.title("Cells by a ladder of distances")
            .purpose(
                "Partitions by distance for several thresholds, each partition once, as alternatives for a filter "
                "that weighs them: which threshold is right need not be known.")
            .equation(
                "for each threshold the connected components of |z_i - z_j|^2 < threshold^2; an alternative's weight "
                "is the share of thresholds that give it")
            .source(
                "K. Granstrom, C. Lundquist, U. Orguner, Extended Target Tracking using a Gaussian-Mixture PHD "
                "Filter, IEEE Transactions on Aerospace and Electronic Systems 48(4), 3268-3286, 2012, III");
        plugin.parameter("thresholds", &DistanceLadder::thresholds_)
            .unit("m")
            .min(1e-9)
            .max(1e15)
            .rows(1, 64)
            .doc("distances below which measurements belong together, ascending");
    }

    void setup(const pelorus::Setup&) {
        for (std::size_t k = 1; k < thresholds_.size(); ++k)
            if (!(thresholds_[k] > thresholds_[k - 1]))
                throw pelorus::ParameterError("thresholds[" + std::to_string(k) + "]",
                                              "is not greater than the one before it");
        info.dimension_min = 1;
        info.dimension_max = 3;
        partition::tell(partition::distance_groups_need(), info);
    }

    plr_status split(const plr_call& call, const plr_partitioner_split& args) const {
        partition::expect_points(info, args);
        partition::Writer writer(*args.out);
        if (args.points.count > 0) write_alternatives(call, args, writer);
        return writer.finish();
    }

private:
    /// A greater threshold joins cells and parts none, so two thresholds give one partition if they give as many cells.
    void write_alternatives(const plr_call& call, const plr_partitioner_split& args, partition::Writer& writer) const {
        partition::CallMemory memory(call, partition::distance_groups_need(), args.points.count);
        const double share = 1.0 / static_cast<double>(thresholds_.size());
        std::uint32_t cells = 0;  // of the alternative being written
        int alike = 0;            // thresholds that give it
        for (const double threshold : thresholds_) {
            if (cells != 1) {  // one cell stays one
                partition::Memory own = memory;
                const partition::Groups groups =
                    partition::distance_groups(own, args.points, threshold, args.parallel, call.error);
                if (groups.count() != cells) {
                    if (alike > 0) writer.alternative(alike * share);
                    writer.cells(groups);
                    cells = groups.count();
                    alike = 0;
                }
            }
            ++alike;
        }
        writer.alternative(alike * share);
    }

    std::vector<double> thresholds_;
};

}  // namespace distance_ladder
