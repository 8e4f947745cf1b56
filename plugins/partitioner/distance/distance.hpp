/// partitioner.distance: measurements that a chain of short links joins are one cell. See README.md.
#pragma once

#include "../../common/partition/distance_groups.hpp"
#include "../../common/partition/threshold_input.hpp"
#include "../../common/partition/writer.hpp"

namespace distance {

class Distance : public pelorus::Partitioner<Distance> {
public:
    static void describe(pelorus::Describe<Distance>& plugin) {
        plugin.title("Cells by distance")
            .purpose(
                "Two measurements are in one cell if a chain of measurements joins them in which each is closer to "
                "the next than a threshold. What the tracker predicts is not looked at.")
            .equation("connected components of the graph |z_i - z_j|^2 < threshold^2")
            .source(
                "K. Granstrom, C. Lundquist, U. Orguner, Extended Target Tracking using a Gaussian-Mixture PHD "
                "Filter, IEEE Transactions on Aerospace and Electronic Systems 48(4), 3268-3286, 2012, III; L. Han, "
                "H. Zhou, Journal of Ordnance Equipment Engineering 41(12), 2020");
        plugin.parameter("threshold", &Distance::threshold_)
            .unit("m")
            .min(1e-9)
            .max(1e15)
            .doc("d0: measurements that are closer than this belong together");
        partition::describe_threshold_input(plugin);
    }

    void setup(const pelorus::Setup&) {
        info.dimension_min = 1;
        info.dimension_max = 3;
        partition::tell(partition::distance_groups_need(), info);
    }

    plr_status split(const plr_call& call, const plr_partitioner_split& args) const {
        const double threshold = partition::threshold_in_force(inputs, call, threshold_);
        partition::expect_points(info, args);
        partition::Writer writer(*args.out);
        if (args.points.count > 0) {
            partition::CallMemory memory(call, partition::distance_groups_need(), args.points.count);
            writer.cells(partition::distance_groups(memory, args.points, threshold, args.parallel, call.error));
            writer.alternative(1);
        }
        return writer.finish();
    }

private:
    double threshold_ = 0;
};

}  // namespace distance
