// Each point is a cell of its own.
#include <pelorus/batch_model.hpp>
#include <pelorus/messages.hpp>

#include "reference_parts.hpp"

namespace pelorus::conformance {

namespace {

struct Partitioner : pelorus::Partitioner<Partitioner> {
    static void describe(Describe<Partitioner>& plugin) { plugin.title("Cells of one point"); }

    void setup(const Setup&) {
        info.dimension_min = 1;
        info.dimension_max = 3;
    }

    plr_status split(const plr_call&, const plr_partitioner_split& args) const {
        const std::int64_t count = args.points.count;
        if (args.points.rows < info.dimension_min || args.points.rows > info.dimension_max)
            throw ArgumentError("points: are of " + std::to_string(args.points.rows) + " dimensions, expected 1 to 3");
        for (std::int64_t k = 0; k < count; ++k)
            if (!item(args.points, k).allFinite()) throw NumericError("a point is not finite");
        plr_partition& out = *args.out;
        out.alternatives = count == 0 ? 0 : 1;
        out.cells = out.members = count;
        if (out.alternative_capacity < out.alternatives || out.cell_capacity < count || out.member_capacity < count)
            return PLR_E_CAPACITY;
        out.alternative_offsets[0] = out.cell_offsets[0] = 0;
        if (count == 0) return PLR_OK;
        out.alternative_offsets[1] = count;
        out.alternative_weights[0] = 1;
        for (std::int64_t i = 0; i < count; ++i) {
            out.cell_offsets[i + 1] = i + 1;
            out.cell_predictions[i] = -1;
            out.member_points[i] = i;
            out.member_weights[i] = 1;
        }
        return PLR_OK;
    }
};

}  // namespace

const plr_plugin* reference_partitioner() {
    return pelorus::detail::plugin<Partitioner>("pelorus.conformance.partitioner", "pelorus.conformance.partitioner");
}

}  // namespace pelorus::conformance
