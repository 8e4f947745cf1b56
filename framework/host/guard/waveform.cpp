#include <pelorus/abi/waveform.h>

#include "host/guard/info.hpp"
#include "host/guard/kinds.hpp"

namespace pelorus::host {

namespace {

GuardSizes sizes_of(const plr_instance& instance) {
    const plr_waveform_info& info = info_of<plr_waveform>(instance);
    GuardSizes sizes;
    sizes.m = size_of_space(info.measurement);
    sizes.w = size_of_space(info.waveform);
    sizes.h = info.horizon;
    sizes.flags = info.flags;
    sizes.scratch = static_cast<std::int64_t>(info.scratch_bytes);
    return sizes;
}

}  // namespace

template <> struct GuardedFunction<&plr_waveform::choose> : PlainFunction {
    static constexpr const char* name = "choose";
    static constexpr std::size_t index = 0;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_waveform_choose& args) {
        const std::int64_t c = args.mean.rows;
        checks.items(args.waveform.count);
        checks.input("mean", args.mean, c, sizes.h);
        checks.input("covariance", args.covariance, c, c * sizes.h);
        checks.input("projected", args.projected, sizes.m, sizes.m * sizes.h);
        checks.input("cross", args.cross, c, sizes.m * sizes.h);
        checks.input("base_noise", args.base_noise, sizes.m, sizes.m);
        checks.input("dt", args.dt, sizes.h, 1);
        checks.output("waveform", args.waveform, sizes.w, 1);
        checks.output("noise", args.noise, sizes.m, sizes.m, Content::covariance);
        checks.output("criterion", args.criterion, 1, 1, Content::not_nan);
    }
};

template <> struct GuardedFunction<&plr_waveform::noise> : PlainFunction {
    static constexpr const char* name = "noise";
    static constexpr std::size_t index = 1;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_waveform_noise& args) {
        checks.items(args.out.count);
        checks.input("waveform", args.waveform, sizes.w, 1);
        checks.input("base_noise", args.base_noise, sizes.m, sizes.m);
        checks.output("out", args.out, sizes.m, sizes.m, Content::covariance);
    }
};

GuardedKind guarded_waveform() noexcept {
    return {&sizes_of, [](unsigned char* table) {
                guard_head<plr_waveform, plr_waveform_info>(table);
                guard_functions<&plr_waveform::choose, &plr_waveform::noise>(table);
            }};
}

}  // namespace pelorus::host
