/// partitioner.predicted_shape: of each prediction the measurements in the gate of its shape. See README.md.
#pragma once

#include "../../common/partition/predicted_cells.hpp"
#include "../../common/partition/threshold_input.hpp"

namespace predicted_shape {

class PredictedShape : public pelorus::Partitioner<PredictedShape>, public partition::PredictedCellSettings {
public:
    static void describe(pelorus::Describe<PredictedShape>& plugin) {
        plugin.flags(PLR_DESCRIPTION_OVERLAP)
            .title("Cells by predicted shape")
            .purpose(
                "Of each prediction the measurements in the gate of its shape. What is in no gate becomes cells by "
                "distance. A measurement may serve several predictions.")
            .equation(
                "gate e' (lambda X + R)^-1 e < chi-square(p, d); weights N(e; 0, H P H' + R)/max(|e|, 1 mm), "
                "normalised")
            .source("L. Han, L. Zhou, Journal of Ordnance Equipment Engineering 41(12), 2020");
        partition::describe_threshold_input(plugin);
        PredictedCellSettings::describe(plugin, "0.99",
                                        "d0: distance below which measurements outside of all gates belong together");
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
        return partition::split_by_predictions(info, settings, false, call, args);
    }
};

}  // namespace predicted_shape
