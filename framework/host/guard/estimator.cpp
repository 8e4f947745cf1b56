#include <pelorus/abi/estimator.h>

#include "host/description.hpp"
#include "host/guard/info.hpp"
#include "host/guard/kinds.hpp"

namespace pelorus::host {

namespace {

GuardSizes sizes_of(const plr_instance& instance) {
    const plr_estimator_info& info = info_of<plr_estimator>(instance);
    GuardSizes sizes;
    sizes.n = size_of_space(info.state);
    sizes.c = size_of_space(info.cartesian);
    sizes.r = info.record_size;
    sizes.flags = info.flags;
    sizes.version = info.record_version;
    sizes.scratch = static_cast<std::int64_t>(info.scratch_bytes);
    for (std::uint32_t i = 0; i < info.sensor_count; ++i)
        sizes.ms.push_back(size_of_space(info_of<plr_sensor>(element(info.sensors, i).instance).measurement));
    return sizes;
}

std::int64_t size_of_sensor(const GuardSizes& sizes, std::int32_t sensor) {
    if (sensor >= 0 && static_cast<std::size_t>(sensor) < sizes.ms.size())
        return sizes.ms[static_cast<std::size_t>(sensor)];
    throw BrokenContract(
        "sensor is " + std::to_string(sensor) + ", the estimator has " + std::to_string(sizes.ms.size()) + " (from 0)",
        -1, true);
}

void declare_moments(CheckedCall& checks, plr_estimator_moments& args, std::int64_t r, std::int64_t components) {
    checks.items(args.mean.count);
    checks.record("record", args.record, r);
    checks.output("mean", args.mean, components, 1);
    checks.output("covariance", args.covariance, components, components, Content::covariance);
}

}  // namespace

template <> struct GuardedFunction<&plr_estimator::init> : PlainFunction {
    static constexpr const char* name = "init";
    static constexpr std::size_t index = 0;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_estimator_init& args) {
        checks.items(args.record.count);
        checks.bytes("components", args.components, args.known * sizeof(std::int32_t));
        checks.input("mean", args.mean, args.known, 1);
        checks.input("covariance", args.covariance, args.known, args.known);
        checks.output("record", args.record, sizes.r, 1, Content::opaque);
    }
};

template <> struct GuardedFunction<&plr_estimator::predict> : PlainFunction {
    static constexpr const char* name = "predict";
    static constexpr std::size_t index = 1;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_estimator_predict& args) {
        checks.items(args.out.count);
        checks.input("dt", args.dt, 1, 1);
        checks.input("extent", args.extent, args.extent.rows, args.extent.rows);
        checks.record_output("out", args.out, sizes.r, "record", args.record);
    }
};

template <> struct GuardedFunction<&plr_estimator::project> : PlainFunction {
    static constexpr const char* name = "project";
    static constexpr std::size_t index = 2;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_estimator_project& args) {
        const std::int64_t m = size_of_sensor(sizes, args.sensor);
        checks.items(args.measurement.count);
        checks.record("record", args.record, sizes.r);
        checks.output("measurement", args.measurement, m, 1);
        checks.output("covariance", args.covariance, m, m, Content::covariance);
        checks.output("cross", args.cross, sizes.n, m);
        checks.output("cartesian_cross", args.cartesian_cross, sizes.c, m);
    }
};

template <> struct GuardedFunction<&plr_estimator::update> : PlainFunction {
    static constexpr const char* name = "update";
    static constexpr std::size_t index = 3;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_estimator_update& args) {
        const std::int64_t m = size_of_sensor(sizes, args.sensor);
        checks.items(args.out.count);
        checks.input("measurement", args.measurement, m, 1);
        checks.input("noise", args.noise, m, m);
        checks.record_output("out", args.out, sizes.r, "record", args.record);
        checks.output("log_likelihood", args.log_likelihood, 1, 1, Content::not_nan);
        checks.output("innovation", args.innovation, m, 1);
        checks.output("innovation_covariance", args.innovation_covariance, m, m, Content::covariance);
    }
};

template <> struct GuardedFunction<&plr_estimator::summary> : PlainFunction {
    static constexpr const char* name = "summary";
    static constexpr std::size_t index = 4;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_estimator_moments& args) {
        declare_moments(checks, args, sizes.r, sizes.c);
    }
};

template <> struct GuardedFunction<&plr_estimator::moments> : PlainFunction {
    static constexpr const char* name = "moments";
    static constexpr std::size_t index = 5;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_estimator_moments& args) {
        declare_moments(checks, args, sizes.r, sizes.n);
    }
};

template <> struct GuardedFunction<&plr_estimator::assign> : PlainFunction {
    static constexpr const char* name = "assign";
    static constexpr std::size_t index = 6;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_estimator_assign& args) {
        checks.items(args.out.count);
        checks.input("mean", args.mean, sizes.n, 1);
        checks.input("covariance", args.covariance, sizes.n, sizes.n);
        checks.record_output("out", args.out, sizes.r, "record", args.record);
    }
};

GuardedKind guarded_estimator() noexcept {
    return {&sizes_of, [](unsigned char* table) {
                guard_head<plr_estimator, plr_estimator_info>(table);
                guard_functions<&plr_estimator::init, &plr_estimator::predict, &plr_estimator::project,
                                &plr_estimator::update, &plr_estimator::summary, &plr_estimator::moments,
                                &plr_estimator::assign>(table);
            }};
}

}  // namespace pelorus::host
