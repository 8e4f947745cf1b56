#include <pelorus/abi/motion.h>

#include "host/guard/info.hpp"
#include "host/guard/kinds.hpp"

namespace pelorus::host {

namespace {

constexpr std::int64_t any = CheckedCall::any_size;

GuardSizes sizes_of(const plr_instance& instance) {
    const plr_motion_info& info = info_of<plr_motion>(instance);
    GuardSizes sizes;
    sizes.n = size_of_space(info.state);
    sizes.c = size_of_space(info.cartesian);
    sizes.r = info.record_size;
    sizes.flags = info.flags;
    sizes.version = info.record_version;
    sizes.scratch = static_cast<std::int64_t>(info.scratch_bytes);
    return sizes;
}

}  // namespace

template <> struct GuardedFunction<&plr_motion::propagate> : PlainFunction {
    static constexpr const char* name = "propagate";
    static constexpr std::size_t index = 0;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_motion_propagate& args) {
        checks.items(args.out.count);
        checks.input("dt", args.dt, 1, 1);
        checks.input("state", args.state, sizes.n, args.out.cols);
        checks.input("mean", args.mean, sizes.n, 1);
        checks.record("record", args.record, sizes.r);
        checks.output("out", args.out, sizes.n, any);
    }
};

template <> struct GuardedFunction<&plr_motion::jacobian> : PlainFunction {
    static constexpr const char* name = "jacobian";
    static constexpr std::size_t index = 1;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_motion_jacobian& args) {
        checks.items(args.out.count);
        checks.input("dt", args.dt, 1, 1);
        checks.input("state", args.state, sizes.n, 1);
        checks.input("mean", args.mean, sizes.n, 1);
        checks.record("record", args.record, sizes.r);
        checks.output("out", args.out, sizes.n, sizes.n);
    }
};

template <> struct GuardedFunction<&plr_motion::noise> : PlainFunction {
    static constexpr const char* name = "noise";
    static constexpr std::size_t index = 2;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_motion_noise& args) {
        checks.items(args.out.count);
        checks.input("dt", args.dt, 1, 1);
        checks.input("state", args.state, sizes.n, 1);
        checks.input("covariance", args.covariance, sizes.n, sizes.n);
        checks.input("predicted", args.predicted, sizes.n, 1);
        checks.input("extent", args.extent, any, args.extent.rows);
        checks.record("record", args.record, sizes.r);
        checks.output("out", args.out, sizes.n, sizes.n, Content::covariance);
    }
};

namespace {

void declare_record(CheckedCall& checks, const GuardSizes& sizes, plr_motion_record& args) {
    checks.items(args.out.count);
    checks.input("dt", args.dt, 1, 1);
    checks.input("state", args.state, sizes.n, 1);
    checks.input("covariance", args.covariance, sizes.n, sizes.n);
    checks.record_output("out", args.out, sizes.r, "record", args.record);
}

void declare_conversion(CheckedCall& checks, plr_motion_convert& args, std::int64_t from, std::int64_t to) {
    checks.items(args.out.count);
    checks.input("in", args.in, from, args.out.cols);
    checks.output("out", args.out, to, any);
    checks.output("jacobian", args.jacobian, to, from);
}

}  // namespace

template <> struct GuardedFunction<&plr_motion::init_record> : PlainFunction {
    static constexpr const char* name = "init_record";
    static constexpr std::size_t index = 3;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_motion_record& args) {
        declare_record(checks, sizes, args);
    }
};

template <> struct GuardedFunction<&plr_motion::advance_record> : PlainFunction {
    static constexpr const char* name = "advance_record";
    static constexpr std::size_t index = 4;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_motion_record& args) {
        declare_record(checks, sizes, args);
    }
};

template <> struct GuardedFunction<&plr_motion::to_cartesian> : PlainFunction {
    static constexpr const char* name = "to_cartesian";
    static constexpr std::size_t index = 5;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_motion_convert& args) {
        declare_conversion(checks, args, sizes.n, sizes.c);
    }
};

template <> struct GuardedFunction<&plr_motion::from_cartesian> : PlainFunction {
    static constexpr const char* name = "from_cartesian";
    static constexpr std::size_t index = 6;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_motion_convert& args) {
        declare_conversion(checks, args, sizes.c, sizes.n);
    }
};

GuardedKind guarded_motion() noexcept {
    return {
        &sizes_of, [](unsigned char* table) {
            guard_head<plr_motion, plr_motion_info>(table);
            guard_functions<&plr_motion::propagate, &plr_motion::jacobian, &plr_motion::noise, &plr_motion::init_record,
                            &plr_motion::advance_record, &plr_motion::to_cartesian, &plr_motion::from_cartesian>(table);
        }};
}

}  // namespace pelorus::host
