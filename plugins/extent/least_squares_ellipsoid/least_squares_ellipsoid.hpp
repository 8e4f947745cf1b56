/// extent.least_squares_ellipsoid: the quadric through each scan's points. See README.md.
///
/// The record: the shape that is told (d x d, m^2), the spread of the points less R (d x d, m^2), scans, and how many of
/// them were fitted by an ellipsoid.
#pragma once

#include <pelorus/batch_model.hpp>

#include "../../common/random_matrix/inverse_wishart.hpp"
#include "../../common/random_matrix/scatter.hpp"
#include "quadric.hpp"

namespace least_squares_ellipsoid {

using random_matrix::Scatter;

struct Parameters {
    double lambda = 1;
    int dimension = 3;
};

template <int D> class LeastSquaresEllipsoid : public pelorus::Extent<LeastSquaresEllipsoid<D>>, public Parameters {
public:
    static void describe(pelorus::Describe<LeastSquaresEllipsoid>& plugin) {
        plugin.title("Ellipsoid by least squares")
            .purpose(
                "The baseline that random matrices are compared with: the quadric that fits the points of one scan "
                "best, with no memory of earlier ones. It takes the points to lie on the surface, which points spread "
                "over a body do not; its half axes are far too large, and often it is no ellipsoid at all.")
            .equation(
                "min sum (q'A q + 2 b'q - 1)^2 over the points q about their mean; half axes sqrt|k/a_i| with a_i the "
                "eigenvalues of A and k = 1 + b'A^-1 b")
            .source("Li et al., Radar Science and Technology 23(1), 2025 (as the baseline there)");
        plugin.parameter("lambda", &Parameters::lambda)
            .initially("1")
            .above(0)
            .doc("covariance of points over the extent matrix, for the centroid's noise in the first scan");
        plugin.parameter("dimension", &Parameters::dimension).initially("3").min(2).max(3).doc("axes: x, y[, z]");
    }

    void setup(const pelorus::Setup&) {
        this->info.dimension = D;
        this->info.flags = PLR_EXTENT_NO_MEMORY;
        this->info.start_scans = 1;
        this->info.start_points = D + 1;
        this->info.record_version = 1;
        this->info.record_size = record_size;
    }

    plr_status init(const plr_call& call, const plr_extent_init& args) const {
        const std::int64_t count = args.record.count;
        random_matrix::expect_start<D>(args.scan, args.scans, 1, count);
        pelorus::expect(args.record, record_size, 1, count, "record");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Scatter<D> scatter = random_matrix::scatter_of<D>(args.scan[0], i);
            if (scatter.points < D + 1)
                throw pelorus::NumericError("the shape starts with at least " + std::to_string(D + 1) +
                                            " points a scan, got " + std::to_string(scatter.points));
            Item item;
            random_matrix::of_full_rank<D>(scatter.sum);
            item.shape = scatter.sum / (lambda * (scatter.number - 1));
            learn(item, args.scan[0], i, scatter);
            write(item, args.record, i);
        });
    }

    /// Nothing is known of how it changes.
    plr_status predict(const plr_call& call, const plr_extent_predict& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.dt, 1, 1, count, "dt");
        expect_records(args.record, args.out);
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const double dt = args.dt.data[i * args.dt.item_stride];
            if (dt < 0) throw pelorus::UnsupportedError("cannot move backward in time (dt < 0)");
            if (!std::isfinite(dt)) throw pelorus::NumericError("dt is not finite");
            write(read(args.record, i), args.out, i);
        });
    }

    plr_status effective_noise(const plr_call& call, const plr_extent_effective_noise& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.record, record_size, 1, count, "record");
        pelorus::expect(args.noise, D, D, count, "noise");
        pelorus::expect(args.number, 1, 1, count, "number");
        pelorus::expect(args.out, D, D, count, "out");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const double number = args.number.data[i * args.number.item_stride];
            if (!(number > 0)) throw pelorus::ArgumentError("number: must be above 0");
            const Matrix<D> point = read(args.record, i).spread + pelorus::load<D, D>(args.noise, i);
            pelorus::store<D, D>(args.out, i, Matrix<D>(point / number));
        });
    }

    plr_status update(const plr_call& call, const plr_extent_update& args) const {
        const std::int64_t count = args.out.count;
        random_matrix::expect_points<D>(args.scan, count);
        expect_records(args.record, args.out);
        if (args.log_likelihood.data != nullptr) pelorus::expect(args.log_likelihood, 1, 1, count, "log_likelihood");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            Item item = read(args.record, i);
            const Scatter<D> scatter = random_matrix::scatter_of<D>(args.scan, i);
            double log_likelihood = 0;
            if (scatter.points > 0) {
                log_likelihood = random_matrix::log_spread<D>(scatter, Matrix<D>(item.spread + scatter.noise));
                learn(item, args.scan, i, scatter);
            }
            write(item, args.out, i);
            if (args.log_likelihood.data != nullptr)
                pelorus::store<1, 1>(args.log_likelihood, i, Matrix<1>::Constant(log_likelihood));
        });
    }

    plr_status shape(const plr_call& call, const plr_extent_shape& args) const {
        const std::int64_t count = args.matrix.count;
        pelorus::expect(args.record, record_size, 1, count, "record");
        random_matrix::expect_shape<D>(args);
        return pelorus::for_items(
            call, count, [&](std::int64_t i) { random_matrix::store_shape<D>(read(args.record, i).shape, args, i); });
    }

    plr_status gate(const plr_call& call, const plr_extent_gate& args) const {
        const std::int64_t count = args.record.count;
        random_matrix::expect_points<D>(args.scan, count);
        pelorus::expect(args.record, record_size, 1, count, "record");
        pelorus::expect(args.predicted, D, 1, count, "predicted");
        pelorus::expect(args.covariance, D, D, count, "covariance");
        pelorus::expect(args.squared_distance, 1, 1, args.scan.offsets[count], "squared_distance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Matrix<D> common = read(args.record, i).spread + pelorus::load<D, D>(args.covariance, i);
            random_matrix::store_distances<D>(args.scan, i, pelorus::load<D, 1>(args.predicted, i), common,
                                              args.squared_distance);
        });
    }

private:
    static constexpr std::int64_t record_size = 2 * D * D + 2;
    struct Item {
        Matrix<D> shape = Matrix<D>::Zero(), spread = Matrix<D>::Zero();
        double scans = 0, ellipsoids = 0;
    };
    static Item read(const plr_const_view& records, std::int64_t i) {
        const double* const at = records.data + i * records.item_stride;
        Item item;
        std::copy_n(at, D * D, item.shape.data());
        std::copy_n(at + D * D, D * D, item.spread.data());
        item.scans = at[2 * D * D];
        item.ellipsoids = at[2 * D * D + 1];
        return item;
    }
    /// Throws NumericError where something is not finite or the spread is not positive definite.
    static void write(const Item& item, const plr_view& records, std::int64_t i) {
        Matrix<D> root;
        if (!pelorus::small::all_finite(item.shape) || !pelorus::small::all_finite(item.spread) ||
            !std::isfinite(item.scans) || !std::isfinite(item.ellipsoids) ||
            !pelorus::small::cholesky(item.spread, root))
            throw pelorus::NumericError("the extent is no longer positive definite");
        double* const at = records.data + i * records.item_stride;
        std::copy_n(item.shape.data(), D * D, at);
        std::copy_n(item.spread.data(), D * D, at + D * D);
        at[2 * D * D] = item.scans;
        at[2 * D * D + 1] = item.ellipsoids;
    }
    static void expect_records(const plr_const_view& record, const plr_view& out) {
        pelorus::expect(record, record_size, 1, out.count, "record");
        pelorus::expect(out, record_size, 1, out.count, "out");
    }

    /// The quadric of a scan's points; points that determine none leave the shape as it is.
    static void learn(Item& item, const plr_extent_points& scan, std::int64_t i, const Scatter<D>& scatter) {
        item.scans += 1;
        if (scatter.points > D) {
            const Matrix<D> spread = scatter.sum / (scatter.number - 1);
            item.spread = random_matrix::with_floor<D>(spread - scatter.noise, 0.05 * spread.trace() / D);
        }
        const double scale = std::sqrt(scatter.sum.trace() / scatter.number);
        if (!(scale > 0)) return;
        Fit<D> fit;
        for (std::int64_t k = scan.offsets[i]; k < scan.offsets[i + 1]; ++k)
            fit.add((pelorus::load<D, 1>(scan.points, k) - scatter.centroid) / scale);
        const auto quadric = fit.solve();
        if (!quadric) return;
        item.shape = quadric->ellipsoid * (scale * scale);
        item.ellipsoids += quadric->is_ellipsoid;
    }
};

}  // namespace least_squares_ellipsoid
