/// partitioner.expectation_maximisation: cells by a mixture of Gaussians, from predictions or from seeds. See README.md.
#pragma once

#include "mixture_cells.hpp"

namespace expectation_maximisation {

class ExpectationMaximisation : public pelorus::Partitioner<ExpectationMaximisation>, public Settings {
public:
    static void describe(pelorus::Describe<ExpectationMaximisation>& plugin) {
        plugin.title("Cells by a mixture of Gaussians")
            .purpose(
                "Fits Gaussians to the measurements and gives each measurement to the most likely one. Where there are "
                "predictions, they are what it begins from, with a background for what is of none; that, and scans "
                "without predictions, begin from the clusters of k-means++, in the number that fits best.")
            .equation("r_ik = w_k N(z_i; m_k, S_k)/sum_l w_l N(z_i; m_l, S_l); w_k, m_k, S_k = moments weighed by r_ik")
            .source(
                "A. Dempster, N. Laird, D. Rubin, Journal of the Royal Statistical Society B 39(1), 1-38, 1977; "
                "K. Granstrom, U. Orguner, A PHD Filter for Tracking Multiple Extended Targets Using Random Matrices, "
                "IEEE Transactions on Signal Processing 60(11), 5657-5671, 2012 (start from predictions)");
        plugin.parameter("most_cells", &Settings::most_cells)
            .initially("8")
            .min(1)
            .max(partition::most_clusters)
            .doc("largest number of cells of no prediction that is tried");
        plugin.parameter("scale", &Settings::scale)
            .initially("0.25")
            .min(0)
            .max(1e6)
            .doc("lambda: measurements of an extent X scatter with lambda X, at the beginning");
        plugin.parameter("least_deviation", &Settings::least_deviation)
            .unit("m")
            .initially("1 m")
            .min(1e-9)
            .max(1e15)
            .doc("least deviation of a Gaussian along any axis; known noise counts, too");
        plugin.parameter("passes", &Settings::passes)
            .initially("200")
            .min(1)
            .max(1e6)
            .doc("most passes over the points");
        plugin.parameter("tries", &Settings::tries).initially("4").min(1).max(1000).doc("beginnings of k-means++");
    }

    void setup(const pelorus::Setup& setup) {
        random = &setup.service<plr_random>();
        info.dimension_min = 1;
        info.dimension_max = 3;
        info.flags = PLR_FLAG_USES_KEYS;
        partition::tell(need(), info);
    }

    plr_status split(const plr_call& call, const plr_partitioner_split& args) const {
        partition::expect_points(info, args);
        partition::Writer writer(*args.out);
        if (args.points.count > 0) {
            if (call.keys == nullptr) throw pelorus::ArgumentError("call.keys: is NULL, but seeds are drawn");
            partition::CallMemory memory(call, need(), args.points.count + args.predictions.count);
            partition::by_dimension(args.points.rows, [&](auto dimension) {
                MixtureCells<decltype(dimension)::value>(memory, *this, call.keys[0], args).write(writer);
            });
            writer.alternative(1);
        }
        return writer.finish();
    }
};

}  // namespace expectation_maximisation
