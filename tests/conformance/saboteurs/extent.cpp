// A plain random matrix, with what an extent may do wrong.
#include "../../../sdk/conformance/reference/scatter_matrix.hpp"
#include "defect.h"

namespace {

struct Saboteur : pelorus::conformance::ScatterMatrix<Saboteur> {
    using Base = pelorus::conformance::ScatterMatrix<Saboteur>;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("An extent with a defect")
            .purpose("A plain random matrix, for the proof that the conformance suites can fail.")
            .equation(
                "X = (w X + Z')/(w + n - 1), Z' = X^1/2 Y^-1/2 Z Y^-1/2 X^1/2, Y = X + R; w decays by e^(-T/memory)")
            .source(
                "M. Feldmann, D. Fraenken, W. Koch, Tracking of extended objects and group targets using random "
                "matrices, IEEE Transactions on Signal Processing 59(4), 2011");
        describe_memory(plugin);
    }

    plr_status init(const plr_call& call, const plr_extent_init& args) const {
        plr_extent_init start = args;
        if (DEFECT("extent-start-as-declared") && args.scan != nullptr) {
            // All objects are refused where one has too few points.
            for (std::int64_t i = 0; i < args.record.count; ++i)
                if (args.scan[0].offsets[i + 1] - args.scan[0].offsets[i] < info.start_points) return refuse(call);
        }
        const plr_status status = Base::init(call, start);
        if (status < 0) return status;
        for (std::int64_t i = 0; i < args.record.count; ++i) {
            double* const record = args.record.data + i * args.record.item_stride;
            if (NEAR_MISS("extent-start-as-declared")) Eigen::Map<Shape>(record + 1) *= 2;
            if (DEFECT("extent-converges-to-shape")) Eigen::Map<Shape>(record + 1) = 100 * Shape::Identity();
        }
        return status;
    }

    plr_status predict(const plr_call& call, const plr_extent_predict& args) const {
        const plr_status status = Base::predict(call, args);
        if (status < 0) return status;
        for (std::int64_t i = 0; i < args.out.count; ++i) {
            double* const record = args.out.data + i * args.out.item_stride;
            // Sure of what it has seen once; and nearly so.
            if (DEFECT("extent-converges-to-shape")) record[0] = 1e9;
            if (NEAR_MISS("extent-converges-to-shape")) record[0] = std::min(record[0], 300.0);
        }
        return status;
    }

    plr_status effective_noise(const plr_call& call, const plr_extent_effective_noise& args) const {
        const plr_status status = Base::effective_noise(call, args);
        if (status < 0) return status;
        for (std::int64_t i = 0; i < args.out.count; ++i) {
            Eigen::Map<Shape> noise(args.out.data + i * args.out.item_stride);
            const double number = args.number.data[i * args.number.item_stride];
            if (DEFECT("extent-effective-noise-shrinks") && std::isfinite(number)) noise *= std::sqrt(number);
            if (NEAR_MISS("extent-effective-noise-shrinks"))  // no share of the extent
                noise = pelorus::load<3, 3>(args.noise, i) / number;
        }
        return status;
    }

    plr_status update(const plr_call& call, const plr_extent_update& args) const {
        plr_extent_update step = args;
        // What comes after needs what was before, which may lie in the output itself.
        expect_records(args.record, args.out);
        expect_optional(args.log_likelihood, 1, 1, args.out.count, "log_likelihood");
        if (DEFECT("extent-in-place-same-bits") || NEAR_MISS("extent-in-place-same-bits"))
            for (std::int64_t i = 0; i < args.out.count; ++i)
                if (DEFECT("extent-in-place-same-bits") || args.out.data != args.record.data)
                    Eigen::Map<Shape>(args.out.data + i * args.out.item_stride + 1).setIdentity();
        plr_status result = PLR_OK;
        for (std::int64_t i = 0; i < args.out.count; ++i) {
            Known before{0, Shape::Zero()};
            const plr_status known =
                pelorus::for_items(pelorus::slice(call, i), 1, [&](std::int64_t) { before = read(args.record, i); });
            if (known < 0) return known;
            if (known != PLR_OK) {
                result = known;
                continue;
            }
            const std::int64_t first = args.scan.offsets[i], points = args.scan.offsets[i + 1] - first;
            const std::int64_t offsets[] = {0, points};
            step.scan = {offsets, pelorus::slice(args.scan.points, first, points),
                         pelorus::slice(args.scan.noise, first, points),
                         pelorus::slice(args.scan.weights, first, points)};
            step.record = pelorus::slice(args.record, i, 1);
            step.out = pelorus::slice(args.out, i, 1);
            step.log_likelihood = pelorus::slice(args.log_likelihood, i, 1);
            const plr_status status = Base::update(pelorus::slice(call, i), step);
            if (status < 0) return status;
            if (status != PLR_OK) result = status;
            if (status == PLR_OK) distort(args, i, before, step.out.data);
        }
        return result;
    }

    plr_status shape(const plr_call& call, const plr_extent_shape& args) const {
        const plr_status status = Base::shape(call, args);
        if (status < 0) return status;
        for (std::int64_t i = 0; i < args.matrix.count; ++i) {
            if (args.half_axes.data != nullptr) {
                Eigen::Map<Point> half_axes(args.half_axes.data + i * args.half_axes.item_stride);
                if (DEFECT("extent-shape-consistent")) half_axes = half_axes.cwiseAbs2().eval();
                if (NEAR_MISS("extent-shape-consistent")) half_axes *= 1 + 1e-12;
            }
            if (args.axes.data != nullptr &&
                NEAR_MISS("extent-shape-consistent"))  // its direction is nobody's business
                Eigen::Map<Shape>(args.axes.data + i * args.axes.item_stride).col(0) *= -1;
        }
        return status;
    }

    plr_status gate(const plr_call& call, const plr_extent_gate& args) const {
        const plr_status status = Base::gate(call, args);
        if (status < 0) return status;
        for (std::int64_t k = 0; k < args.scan.offsets[args.record.count]; ++k) {
            double& square = args.squared_distance.data[k * args.squared_distance.item_stride];
            if (DEFECT("extent-gate-is-a-distance")) square = std::sqrt(square);
            if (DEFECT("extent-gate-is-a-distance.narrow")) square *= 3;
            if (NEAR_MISS("extent-gate-is-a-distance")) square *= 0.5;
        }
        return status;
    }

private:
    void distort(const plr_extent_update& args, std::int64_t i, const Known& before, double* record) const {
        Eigen::Map<Shape> shape(record + 1);
        const bool saw_nothing = args.scan.offsets[i + 1] == args.scan.offsets[i];
        if (saw_nothing) {
            if (DEFECT("extent-no-points-copies")) shape *= 1 + 1e-9;
            return;
        }
        if (NEAR_MISS("extent-no-points-copies")) record[0] += 1e-9;
        if (DEFECT("extent-follows-rotation-and-shift")) shape(0, 0) *= 1.02;
        if (NEAR_MISS("extent-follows-rotation-and-shift")) shape(0, 0) *= 1 + 1e-10;
        const Cloud cloud = cloud_of(args.scan, i);
        if (DEFECT("extent-stays-positive") &&
            cloud.number > 1) {  // the noise is subtracted, and nothing kept above it
            shape = (before.weight * before.shape + cloud.scatter - (cloud.number - 1) * cloud.noise) /
                    (before.weight + cloud.number - 1);
            pelorus::small::symmetrise(shape);
        }
        if (NEAR_MISS("extent-stays-positive")) shape = 0.5 * (shape + before.shape);
        if (DEFECT("extent-equal-weights-are-none") && args.scan.weights.data != nullptr) {  // as if nothing was seen
            record[0] = before.weight;
            shape = before.shape;
        }
        if (NEAR_MISS("extent-equal-weights-are-none") && args.scan.weights.data != nullptr) shape *= 1 + 1e-12;
    }
    static plr_status refuse(const plr_call& call) {
        return pelorus::guarded(call.error, [] { throw pelorus::NumericError("too few points to begin with"); });
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.extent.saboteur");
