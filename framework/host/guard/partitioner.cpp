#include <pelorus/abi/partitioner.h>

#include <fmt/format.h>

#include "host/first_size.hpp"
#include "host/guard/info.hpp"
#include "host/guard/kinds.hpp"

namespace pelorus::host {

namespace {

GuardSizes sizes_of(const plr_instance& instance) {
    const plr_partitioner_info& info = info_of<plr_partitioner>(instance);
    GuardSizes sizes;
    sizes.least_d = info.dimension_min;
    sizes.d = info.dimension_max;
    sizes.flags = info.flags;
    sizes.scratch = static_cast<std::int64_t>(info.scratch_bytes);
    return sizes;
}

void expect_ascending(const char* name, const std::int64_t* offsets, std::int64_t count, std::int64_t total) {
    if (offsets[0] != 0) throw BrokenContract(fmt::format("{}[0] is {}, expected 0", name, offsets[0]));
    for (std::int64_t i = 0; i < count; ++i)
        if (offsets[i + 1] < offsets[i])
            throw BrokenContract(fmt::format("{0}[{1}] is {2}, less than {0}[{3}], which is {4}", name, i + 1,
                                             offsets[i + 1], i, offsets[i]));
    if (offsets[count] != total)
        throw BrokenContract(
            fmt::format("{}[{}] is {}, expected {}, the last one", name, count, offsets[count], total));
}

/// Whether each point is where it has to be, for one alternative.
void check_alternative(const plr_partition& out, std::int64_t alternative, std::int64_t points, bool overlap) {
    std::vector<char> seen(static_cast<std::size_t>(points), 0);
    for (std::int64_t cell = out.alternative_offsets[alternative]; cell < out.alternative_offsets[alternative + 1];
         ++cell)
        for (std::int64_t k = out.cell_offsets[cell]; k < out.cell_offsets[cell + 1]; ++k) {
            const std::int64_t point = out.member_points[k];
            if (point < 0 || point >= points)
                throw BrokenContract(
                    fmt::format("member_points[{}] is {}, there are points 0 to {}", k, point, points - 1));
            char& mark = seen[static_cast<std::size_t>(point)];
            if (mark != 0 && !overlap)
                throw BrokenContract(
                    fmt::format("point {} is in two cells of alternative {}, and the description declares no overlap",
                                point, alternative));
            mark = 1;
        }
    for (std::int64_t point = 0; point < points; ++point)
        if (seen[static_cast<std::size_t>(point)] == 0)
            throw BrokenContract(fmt::format("point {} is in no cell of alternative {}", point, alternative));
}

void expect_within(const char* name, std::int64_t number, std::int64_t capacity) {
    if (number < 0 || number > capacity)
        throw BrokenContract(fmt::format("it answers {} {}, the buffer holds {}", number, name, capacity));
}

}  // namespace

template <> struct GuardedFunction<&plr_partitioner::split> {
    static constexpr const char* name = "split";
    static constexpr std::size_t index = 0;

    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_partitioner_split& args) {
        const std::int64_t d = args.points.rows, count = args.points.count, predicted = args.predictions.count;
        checks.items(1);  // a split is one item
        if (d < sizes.least_d || d > sizes.d)
            throw BrokenContract(fmt::format("points of {} dimensions, it takes {} to {}", d, sizes.least_d, sizes.d),
                                 -1, true);
        if (args.out == nullptr || args.out->struct_size < first_size<plr_partition>)
            throw BrokenContract("out is missing or too short", -1, true);
        checks.shared_input("points", args.points, d, 1, count);
        checks.shared_input("covariance", args.covariance, d, d, count);
        checks.bytes("predictions.ids", args.predictions.ids,
                     static_cast<std::size_t>(predicted) * sizeof(std::uint64_t));
        checks.shared_input("predictions.mean", args.predictions.mean, d, 1, predicted);
        checks.shared_input("predictions.covariance", args.predictions.covariance, d, d, predicted);
        checks.shared_input("predictions.extent", args.predictions.extent, d, d, predicted);
    }

    struct Kept {
        Kept(const GuardRecord& of_part, const plr_partitioner_split& given, plr_partitioner_split& args,
             CheckedCall& checks)
            : record(of_part),
              points(given.points.count),
              predictions(given.predictions.count),
              callers(*given.out),
              own(callers) {
            args.out = &own;
            checks.output_array("alternative_offsets", own.alternative_offsets, own.alternative_capacity + 1,
                                Content::opaque);
            checks.output_array("alternative_weights", own.alternative_weights, own.alternative_capacity,
                                Content::opaque);
            checks.output_array("cell_offsets", own.cell_offsets, own.cell_capacity + 1, Content::opaque);
            checks.output_array("cell_predictions", own.cell_predictions, own.cell_capacity, Content::opaque);
            checks.output_array("member_points", own.member_points, own.member_capacity, Content::opaque);
            checks.output_array("member_weights", own.member_weights, own.member_capacity, Content::opaque);
        }

        void returned(plr_status status) const {
            callers.alternatives = own.alternatives;
            callers.cells = own.cells;
            callers.members = own.members;
            if (status == PLR_E_CAPACITY && own.alternatives <= own.alternative_capacity &&
                own.cells <= own.cell_capacity && own.members <= own.member_capacity)
                throw BrokenContract(
                    fmt::format("it answered PLR_E_CAPACITY, but the {} alternatives, {} cells and {} "
                                "members that it asks for were given",
                                own.alternatives, own.cells, own.members));
            if (status < 0) return;
            expect_within("alternatives", own.alternatives, own.alternative_capacity);
            expect_within("cells", own.cells, own.cell_capacity);
            expect_within("members", own.members, own.member_capacity);
        }

        void look() const {
            const plr_partition& out = callers;
            if (out.alternatives == 0 && points > 0)
                throw BrokenContract(fmt::format("it answers no alternative for {} points", points));
            expect_ascending("alternative_offsets", out.alternative_offsets, out.alternatives, out.cells);
            expect_ascending("cell_offsets", out.cell_offsets, out.cells, out.members);
            for (std::int64_t cell = 0; cell < out.cells; ++cell)
                if (out.cell_predictions[cell] < -1 || out.cell_predictions[cell] >= predictions)
                    throw BrokenContract(fmt::format("cell_predictions[{}] is {}, expected -1 to {}", cell,
                                                     out.cell_predictions[cell], predictions - 1));
            for (std::int64_t i = 0; i < out.alternatives; ++i)
                check_alternative(out, i, points, record.cells_may_overlap);
        }

        const GuardRecord& record;
        const std::int64_t points, predictions;
        plr_partition& callers;
        plr_partition own;
    };
};

GuardedKind guarded_partitioner() noexcept {
    return {&sizes_of, [](unsigned char* table) {
                guard_head<plr_partitioner, plr_partitioner_info>(table);
                guard_functions<&plr_partitioner::split>(table);
            }};
}

}  // namespace pelorus::host
