#include <cmath>

#include <pelorus/abi/extent.h>

#include "host/guard/info.hpp"
#include "host/guard/kinds.hpp"

namespace pelorus::host {

namespace {

constexpr std::int64_t any = CheckedCall::any_size;

GuardSizes sizes_of(const plr_instance& instance) {
    const plr_extent_info& info = info_of<plr_extent>(instance);
    GuardSizes sizes;
    sizes.d = info.dimension;
    sizes.r = info.record_size;
    sizes.flags = info.flags;
    sizes.version = info.record_version;
    sizes.scratch = static_cast<std::int64_t>(info.scratch_bytes);
    return sizes;
}

/// Answers the number of points of all items together.
std::int64_t declare_points(CheckedCall& checks, const plr_extent_points& scan, std::int64_t count, std::int64_t d) {
    if (scan.offsets == nullptr || scan.offsets[0] != 0)
        throw BrokenContract("the offsets of its points do not begin with 0", -1, true);
    for (std::int64_t i = 0; i < count; ++i)
        if (scan.offsets[i + 1] < scan.offsets[i])
            throw BrokenContract("the offsets of its points do not ascend", -1, true);
    const std::int64_t total = scan.offsets[count];
    checks.bytes("offsets", scan.offsets, static_cast<std::size_t>(count + 1) * sizeof(std::int64_t));
    checks.shared_input("points", scan.points, d, 1, total);
    checks.shared_input("noise", scan.noise, d, d, total);
    checks.shared_input("weights", scan.weights, 1, 1, total);
    return total;
}

}  // namespace

template <> struct GuardedFunction<&plr_extent::init> : PlainFunction {
    static constexpr const char* name = "init";
    static constexpr std::size_t index = 0;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_extent_init& args) {
        checks.items(args.record.count);
        for (std::uint32_t k = 0; k < args.scans; ++k) declare_points(checks, args.scan[k], args.record.count, sizes.d);
        checks.shared_input("times", args.times, args.scans, 1, 1);
        checks.output("record", args.record, sizes.r, 1, Content::opaque);
    }
};

template <> struct GuardedFunction<&plr_extent::predict> : PlainFunction {
    static constexpr const char* name = "predict";
    static constexpr std::size_t index = 1;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_extent_predict& args) {
        const std::int64_t c = args.before.rows;
        checks.items(args.out.count);
        checks.input("dt", args.dt, 1, 1);
        checks.input("before", args.before, any, 1);
        checks.input("after", args.after, c, 1);
        checks.input("before_covariance", args.before_covariance, c, c);
        checks.input("after_covariance", args.after_covariance, c, c);
        checks.record_output("out", args.out, sizes.r, "record", args.record);
    }
};

template <> struct GuardedFunction<&plr_extent::effective_noise> : PlainFunction {
    static constexpr const char* name = "effective_noise";
    static constexpr std::size_t index = 2;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_extent_effective_noise& args) {
        checks.items(args.out.count);
        checks.record("record", args.record, sizes.r);
        checks.input("noise", args.noise, sizes.d, sizes.d);
        checks.input("number", args.number, 1, 1);
        checks.output("out", args.out, sizes.d, sizes.d, Content::covariance);
    }
};

template <> struct GuardedFunction<&plr_extent::update> : PlainFunction {
    static constexpr const char* name = "update";
    static constexpr std::size_t index = 3;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_extent_update& args) {
        checks.items(args.out.count);
        declare_points(checks, args.scan, args.out.count, sizes.d);
        checks.input("innovation", args.innovation, sizes.d, 1);
        checks.input("innovation_covariance", args.innovation_covariance, sizes.d, sizes.d);
        checks.input("kinematics", args.kinematics, any, 1);
        checks.input("kinematics_covariance", args.kinematics_covariance, args.kinematics.rows, args.kinematics.rows);
        checks.record_output("out", args.out, sizes.r, "record", args.record);
        checks.output("log_likelihood", args.log_likelihood, 1, 1, Content::not_nan);
    }
};

template <> struct GuardedFunction<&plr_extent::shape> : PlainFunction {
    static constexpr const char* name = "shape";
    static constexpr std::size_t index = 4;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_extent_shape& args) {
        checks.items(args.matrix.count);
        checks.record("record", args.record, sizes.r);
        checks.output("matrix", args.matrix, sizes.d, sizes.d, Content::covariance);
        checks.output("half_axes", args.half_axes, sizes.d, 1);
        checks.output("axes", args.axes, sizes.d, sizes.d);
    }
};

template <> struct GuardedFunction<&plr_extent::gate> {
    /// Distances lie point by point, so which item has failed is found by the offsets.
    struct Kept {
        Kept(const GuardRecord&, const plr_extent_gate& of_holder, plr_extent_gate&, const CheckedCall& of_call)
            : given(of_holder), checks(of_call) {}
        void returned(plr_status) const noexcept {}
        void look() const {
            const plr_view& distance = given.squared_distance;
            if (distance.data == nullptr) return;
            for (std::int64_t item = 0; item < given.predicted.count; ++item)
                for (std::int64_t k = given.scan.offsets[item]; k < given.scan.offsets[item + 1]; ++k)
                    if (std::isnan(distance.data[k * distance.item_stride]) && checks.item_counts(item) &&
                        checks.inputs_are_finite(item))
                        throw BrokenContract(
                            "squared_distance of point " + std::to_string(k) + " is nan, expected a number", item);
        }
        const plr_extent_gate& given;
        const CheckedCall& checks;
    };
    static constexpr const char* name = "gate";
    static constexpr std::size_t index = 5;
    static void declare(CheckedCall& checks, const GuardSizes& sizes, plr_extent_gate& args) {
        checks.items(args.predicted.count);
        const std::int64_t total = declare_points(checks, args.scan, args.predicted.count, sizes.d);
        checks.record("record", args.record, sizes.r);
        checks.input("predicted", args.predicted, sizes.d, 1);
        checks.input("covariance", args.covariance, sizes.d, sizes.d);
        checks.shared_output("squared_distance", args.squared_distance, 1, 1, total, Content::opaque);
    }
};

GuardedKind guarded_extent() noexcept {
    return {&sizes_of, [](unsigned char* table) {
                guard_head<plr_extent, plr_extent_info>(table);
                guard_functions<&plr_extent::init, &plr_extent::predict, &plr_extent::effective_noise,
                                &plr_extent::update, &plr_extent::shape, &plr_extent::gate>(table);
            }};
}

}  // namespace pelorus::host
