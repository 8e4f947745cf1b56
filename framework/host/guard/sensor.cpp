#include <pelorus/abi/sensor.h>

#include "host/guard/info.hpp"
#include "host/guard/kinds.hpp"

namespace pelorus::host {

namespace {

constexpr std::int64_t any = CheckedCall::any_size;

GuardSizes sizes_of(const plr_instance& instance) {
    const plr_sensor_info& info = info_of<plr_sensor>(instance);
    GuardSizes sizes;
    sizes.m = size_of_space(info.measurement);
    sizes.c = size_of_space(info.cartesian);
    sizes.i = size_of_space(info.inverse);
    sizes.w = size_of_space(info.waveform);
    sizes.flags = info.flags;
    sizes.scratch = static_cast<std::int64_t>(info.scratch_bytes);
    return sizes;
}

}  // namespace

template <> struct GuardedFunction<&plr_sensor::measure> : PlainFunction {
    static constexpr const char* name = "measure";
    static constexpr std::size_t index = 0;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_sensor_measure& args) {
        checks.items(args.out.count);
        checks.input("cartesian", args.cartesian, sizes.c, args.out.cols);
        checks.output("out", args.out, sizes.m, any);
    }
};

template <> struct GuardedFunction<&plr_sensor::jacobian> : PlainFunction {
    static constexpr const char* name = "jacobian";
    static constexpr std::size_t index = 1;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_sensor_jacobian& args) {
        checks.items(args.out.count);
        checks.input("cartesian", args.cartesian, sizes.c, 1);
        checks.output("out", args.out, sizes.m, sizes.c);
    }
};

template <> struct GuardedFunction<&plr_sensor::noise> : PlainFunction {
    static constexpr const char* name = "noise";
    static constexpr std::size_t index = 2;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_sensor_noise& args) {
        checks.items(args.out.count);
        checks.input("cartesian", args.cartesian, sizes.c, 1);
        checks.input("snr", args.snr, 1, 1);
        checks.input("waveform", args.waveform, sizes.w, 1);
        checks.output("out", args.out, sizes.m, sizes.m, Content::covariance);
    }
};

template <> struct GuardedFunction<&plr_sensor::residual> : PlainFunction {
    static constexpr const char* name = "residual";
    static constexpr std::size_t index = 3;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_sensor_residual& args) {
        checks.items(args.out.count);
        checks.input("measurement", args.measurement, sizes.m, args.out.cols);
        checks.input("reference", args.reference, sizes.m, args.reference.cols == 1 ? 1 : args.out.cols);
        checks.output("out", args.out, sizes.m, any);
    }
};

template <> struct GuardedFunction<&plr_sensor::invert> : PlainFunction {
    static constexpr const char* name = "invert";
    static constexpr std::size_t index = 4;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_sensor_invert& args) {
        checks.items(args.mean.count);
        checks.input("measurement", args.measurement, sizes.m, 1);
        checks.input("noise", args.noise, sizes.m, sizes.m);
        checks.output("mean", args.mean, sizes.i, 1);
        checks.output("covariance", args.covariance, sizes.i, sizes.i, Content::covariance);
    }
};

GuardedKind guarded_sensor() noexcept {
    return {&sizes_of, [](unsigned char* table) {
                guard_head<plr_sensor, plr_sensor_info>(table);
                guard_functions<&plr_sensor::measure, &plr_sensor::jacobian, &plr_sensor::noise, &plr_sensor::residual,
                                &plr_sensor::invert>(table);
            }};
}

}  // namespace pelorus::host
