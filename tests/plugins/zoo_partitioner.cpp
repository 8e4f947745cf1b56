// The zoo's partitioner: each point is a cell of its own, with a misdeed.
#include "zoo.hpp"

namespace {

enum class Wrong { none, over_capacity, no_capacity, twice, left_out, out_of_range, descending, prediction, throws };

struct ZooPartitioner : pelorus::Partitioner<ZooPartitioner> {
    Wrong fault = Wrong::none;

    static void describe(pelorus::Describe<ZooPartitioner>& plugin) {
        plugin.title("A partitioner of the zoo");
        plugin.parameter("fault", &ZooPartitioner::fault)
            .initially("none")
            .choices({{"none", "works well"},
                      {"over_capacity", "claims more members than the buffer holds"},
                      {"no_capacity", "asks for what it has"},
                      {"twice", "a point in two cells"},
                      {"left_out", "a point in no cell"},
                      {"out_of_range", "a point that there is not"},
                      {"descending", "offsets that descend"},
                      {"prediction", "a prediction that there is not"},
                      {"throws", "an exception through the C table"}})
            .doc("the misdeed");
    }
    void setup(const pelorus::Setup&) {
        info.dimension_min = 1;
        info.dimension_max = 3;
    }

    plr_status split(const plr_call&, const plr_partitioner_split& args) const {
        plr_partition& out = *args.out;
        const std::int64_t count = args.points.count;
        out.alternatives = count == 0 ? 0 : 1;
        out.cells = out.members = count;
        if (count > out.cell_capacity || count > out.member_capacity || fault == Wrong::no_capacity)
            return PLR_E_CAPACITY;
        out.alternative_offsets[0] = out.cell_offsets[0] = 0;
        if (count == 0) return PLR_OK;
        out.alternative_offsets[1] = count;
        out.alternative_weights[0] = 1;
        for (std::int64_t i = 0; i < count; ++i) {
            out.cell_predictions[i] = -1;
            out.cell_offsets[i + 1] = i + 1;
            out.member_points[i] = i;
            out.member_weights[i] = 1;
        }
        if (fault == Wrong::over_capacity) out.members = out.member_capacity + 1;
        if (fault == Wrong::twice) out.member_points[count - 1] = 0;
        if (fault == Wrong::left_out) out.members = out.cell_offsets[count] = out.cell_offsets[count - 1];
        if (fault == Wrong::out_of_range) out.member_points[0] = count;
        if (fault == Wrong::descending) out.cell_offsets[1] = -1;
        if (fault == Wrong::prediction) out.cell_predictions[0] = 5;
        return PLR_OK;
    }

    static plr_status split_entry(const void* self, const plr_call* call, const plr_partitioner_split* args) {
        const auto& zoo = *static_cast<const ZooPartitioner*>(self);
        if (zoo.fault == Wrong::throws) throw std::runtime_error("boom");
        return zoo.split(*call, *args);
    }
    static const plr_partitioner& table() {
        static const plr_partitioner zoo = [] {
            plr_partitioner t = pelorus::Partitioner<ZooPartitioner>::table();
            t.split = &split_entry;
            return t;
        }();
        return zoo;
    }
};

}  // namespace

PELORUS_PLUGIN(ZooPartitioner, "org.example.partitioner.zoo");
