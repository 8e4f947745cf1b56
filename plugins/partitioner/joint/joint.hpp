/// partitioner.joint: of each prediction the measurements in its gate, split by distance once more. See README.md.
#pragma once

#include "../../common/partition/predicted_cells.hpp"
#include "../../common/partition/threshold_input.hpp"

namespace joint {

class Joint : public pelorus::Partitioner<Joint>, public partition::PredictedCellSettings {
public:
    static void describe(pelorus::Describe<Joint>& plugin) {
        plugin.flags(PLR_DESCRIPTION_OVERLAP)
            .title("Cells by predicted shape and distance")
            .purpose(
                "Of each prediction the measurements in the gate of its shape; what a gate holds is split by "
                "distance, and the prediction keeps the part that is statistically nearest to it. What no "
                "prediction keeps becomes cells by distance. A measurement may serve several predictions.")
            .equation(
                "gate e' (lambda X + R)^-1 e < chi-square(p, d); the part with the least e' (H P H' + mean R)^-1 "
                "e; weights N(e; 0, H P H' + R)/max(|e|, 1 mm), normalised")
            .source("L. Han, L. Zhou, Journal of Ordnance Equipment Engineering 41(12), 2020");
        partition::describe_threshold_input(plugin);
        PredictedCellSettings::describe(plugin, "0.9999",
                                        "d0: distance below which measurements belong together, in a gate and outside");
        plugin.parameter("repartition", &Joint::repartition_)
            .initially("true")
            .doc("split what a gate holds; false: as printed, a gate keeps all that it holds");
    }

    void setup(const pelorus::Setup&) {
        info.dimension_min = 1;
        info.dimension_max = 3;
        gate.set(gate_probability);
        partition::tell(need(), info);
    }

    plr_status split(const plr_call& call, const plr_partitioner_split& args) const {
        partition::PredictedCellSettings settings = *this;
        settings.threshold = partition::threshold_in_force(inputs, call, threshold);
        return partition::split_by_predictions(info, settings, repartition_, call, args);
    }

private:
    bool repartition_ = true;
};

}  // namespace joint
