// A stage that splits each scan by the partitioner in its slot, so that one can be seen at work.
#include "zoo.hpp"

namespace {

struct ZooCells : pelorus::Stage<ZooCells> {
    static constexpr const char* kind = "analyzer";
    pelorus::PartitionerPart partitioner;
    pelorus::Caller caller;

    static void describe(pelorus::Describe<ZooCells>& plugin) {
        plugin.title("Cells of each scan");
        plugin.slot("partitioner", "partitioner", 1, 1, "what splits");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "measurements of position");
    }
    void setup(const pelorus::Setup& setup) {
        partitioner = setup.part<pelorus::PartitionerPart>("partitioner");
        caller.setup(setup);
    }
    void on_scan(const pelorus::Event& event, const plr_scan& scan) {
        const std::int64_t count = scan.measurements.count;
        const auto size = static_cast<std::size_t>(count) + 1;
        // As large as the guard needs to see that nobody writes outside them: a partition claims, it does not write, too much.
        std::vector<std::int64_t> alternatives(2), cells(size), predictions(size), members(size);
        std::vector<double> alternative_weights(1), member_weights(size);
        plr_partition out{sizeof(plr_partition),
                          0,
                          1,
                          count,
                          count,
                          0,
                          0,
                          0,
                          alternatives.data(),
                          alternative_weights.data(),
                          cells.data(),
                          predictions.data(),
                          members.data(),
                          member_weights.data()};
        auto args = pelorus::arguments<plr_partitioner_split>();
        args.points = scan.measurements;
        args.covariance = scan.covariances;
        args.out = &out;
        caller.require(partitioner.call(&plr_partitioner::split, caller.begin(event.time, 1), args), "split");
    }
};

}  // namespace

PELORUS_PLUGIN(ZooCells, "org.example.analyzer.zoo_cells");
