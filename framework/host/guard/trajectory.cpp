#include <cmath>

#include <fmt/format.h>
#include <pelorus/abi/trajectory.h>

#include "host/guard/info.hpp"
#include "host/guard/kinds.hpp"

namespace pelorus::host {

namespace {

GuardSizes sizes_of(const plr_instance& instance) {
    const plr_trajectory_info& info = info_of<plr_trajectory>(instance);
    GuardSizes sizes;
    sizes.c = size_of_space(info.state);
    sizes.o = info.objects;
    sizes.d = info.extent_dimension;
    sizes.r = info.record_size;
    sizes.flags = info.flags;
    sizes.version = info.record_version;
    sizes.scratch = static_cast<std::int64_t>(info.scratch_bytes);
    return sizes;
}

}  // namespace

template <> struct GuardedFunction<&plr_trajectory::realise> : PlainFunction {
    static constexpr const char* name = "realise";
    static constexpr std::size_t index = 0;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_view& record) {
        checks.items(1);
        if (sizes.r > 0) checks.output("record", record, sizes.r, 1, Content::opaque);
    }
};

template <> struct GuardedFunction<&plr_trajectory::states> {
    static constexpr const char* name = "states";
    static constexpr std::size_t index = 1;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_trajectory_states& args) {
        checks.items(1);
        checks.record("record", args.record, sizes.r);
        checks.bytes("times", args.times, static_cast<std::size_t>(args.time_count) * sizeof(std::int64_t));
        checks.shared_output("states", args.states, sizes.c, args.time_count, sizes.o, Content::any);
        checks.shared_output("extents", args.extents, sizes.d * sizes.d, args.time_count, sizes.o, Content::opaque);
        checks.output_array("ids", args.ids, sizes.o, Content::any);
        checks.output_array("parents", args.parents, sizes.o, Content::any);
        checks.output_array("births", args.births, sizes.o, Content::any);
        checks.output_array("deaths", args.deaths, sizes.o, Content::any);
    }

    /// A state is NaN as a whole, and only where the object does not exist.
    struct Kept {
        Kept(const GuardRecord&, const plr_trajectory_states& of_holder, plr_trajectory_states&,
             const CheckedCall& of_call)
            : given(of_holder), checks(of_call) {}
        void returned(plr_status) const noexcept {}
        void look() const {
            const plr_view& states = given.states;
            if (states.data == nullptr || !checks.item_counts(0) || !checks.inputs_are_finite(0)) return;
            for (std::int64_t object = 0; object < states.count; ++object)
                for (std::int64_t k = 0; k < given.time_count; ++k) look_at(object, k);
        }
        void look_at(std::int64_t object, std::int64_t k) const {
            const plr_view& states = given.states;
            const double* const state = states.data + object * states.item_stride + k * states.col_stride;
            std::int64_t finite = 0;
            for (std::int64_t row = 0; row < states.rows; ++row)
                finite += std::isfinite(state[row * states.row_stride]);
            const bool lives = given.births != nullptr && given.deaths != nullptr &&
                               given.births[object] < given.times[k] && given.times[k] < given.deaths[object];
            if (finite == states.rows || (finite == 0 && !lives && std::isnan(state[0]))) return;
            throw BrokenContract(fmt::format(
                "the state of object {} at {} ns has {} components of {} that are finite numbers, expected {}", object,
                given.times[k], finite, states.rows,
                lives ? "all, as it exists then" : "all or, where it does not exist, nan in all"));
        }
        const plr_trajectory_states& given;
        const CheckedCall& checks;
    };
};

GuardedKind guarded_trajectory() noexcept {
    return {&sizes_of, [](unsigned char* table) {
                guard_head<plr_trajectory, plr_trajectory_info>(table);
                guard_functions<&plr_trajectory::realise, &plr_trajectory::states>(table);
            }};
}

}  // namespace pelorus::host
