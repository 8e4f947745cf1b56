/// A plain random matrix (after M. Feldmann, D. Fraenken, W. Koch, Tracking of extended objects and group targets using random
/// matrices, IEEE Transactions on Signal Processing 59(4), 2011, without the innovation's share): the shape X is the mean of the
/// scatters seen, each freed of the sensor's noise, weighted by the number of points; the weight decays with time. Points are
/// taken to be N(centre, X + R).
///
/// The record of an object: [weight, X (3 x 3)].
#pragma once

#include <algorithm>
#include <cmath>

#include <pelorus/pelorus.hpp>
#include <pelorus/small_matrix.hpp>

namespace pelorus::conformance {

/// A class derived from it adds `describe`; see describe_memory.
template <class Derived> struct ScatterMatrix : pelorus::Extent<Derived> {
    static constexpr int dimension = 3;
    using pelorus::Extent<Derived>::info;
    using Shape = pelorus::Matrix<dimension>;
    using Point = pelorus::Vector<dimension>;
    double memory = 0;  // s

    static void describe_memory(pelorus::Describe<Derived>& plugin) {
        plugin.parameter("memory", &ScatterMatrix::memory)
            .unit("s")
            .initially("100 s")
            .above(0)
            .doc("how long points count");
    }

    void setup(const pelorus::Setup&) {
        info.dimension = dimension;
        info.start_scans = 1;
        info.start_points = dimension + 1;
        info.record_version = 1;
        info.record_size = 1 + dimension * dimension;
    }

    /// What an item's points say together.
    struct Cloud {
        double number = 0;  // 1 / sum w^2
        Point centroid = Point::Zero();
        Shape scatter = Shape::Zero();  // undivided
        Shape noise = Shape::Zero();    // weighted mean of R
    };
    struct Known {
        double weight;
        Shape shape;
    };

    plr_status init(const plr_call& call, const plr_extent_init& args) const {
        const std::int64_t count = args.record.count;
        if (args.scans != 1 || args.scan == nullptr)
            throw pelorus::ArgumentError("scans: is " + std::to_string(args.scans) + ", expected 1");
        expect_points(args.scan[0], count);
        pelorus::expect(args.record, info.record_size, 1, count, "record");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Cloud cloud = cloud_of(args.scan[0], i);
            if (args.scan[0].offsets[i + 1] - args.scan[0].offsets[i] < info.start_points)
                throw pelorus::NumericError("too few points to begin with");
            const Shape spread = cloud.scatter / (cloud.number - 1);
            write(args.record, i,
                  {cloud.number - 1, with_floor(spread - cloud.noise, 0.05 * spread.trace() / dimension)});
        });
    }

    plr_status predict(const plr_call& call, const plr_extent_predict& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.dt, 1, 1, count, "dt");
        expect_records(args.record, args.out);
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const double dt = args.dt.data[i * args.dt.item_stride];
            if (dt < 0) throw pelorus::UnsupportedError("cannot move backward in time (dt < 0)");
            const Known known = read(args.record, i);
            write(args.out, i, {known.weight * std::exp(-dt / memory), known.shape});
        });
    }

    plr_status effective_noise(const plr_call& call, const plr_extent_effective_noise& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.record, info.record_size, 1, count, "record");
        pelorus::expect(args.noise, dimension, dimension, count, "noise");
        pelorus::expect(args.number, 1, 1, count, "number");
        pelorus::expect(args.out, dimension, dimension, count, "out");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const double number = args.number.data[i * args.number.item_stride];
            if (!(number > 0)) throw pelorus::ArgumentError("number: must be above 0");
            pelorus::store<dimension, dimension>(
                args.out, i,
                Shape((read(args.record, i).shape + pelorus::load<dimension, dimension>(args.noise, i)) / number));
        });
    }

    plr_status update(const plr_call& call, const plr_extent_update& args) const {
        const std::int64_t count = args.out.count;
        expect_points(args.scan, count);
        expect_records(args.record, args.out);
        expect_optional(args.log_likelihood, 1, 1, count, "log_likelihood");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            Known known = read(args.record, i);
            const Cloud cloud = cloud_of(args.scan, i);
            double log_likelihood = 0;
            if (std::isnan(cloud.number)) throw NumericError("weights: not a number");
            if (cloud.number > 1) {  // one point has no spread
                const Shape point = known.shape + cloud.noise;
                log_likelihood = log_spread(cloud, point);
                Shape root, inverse, factor, freed;
                if (!small::square_root(known.shape, root) || !small::inverse_square_root(point, inverse))
                    throw pelorus::NumericError("the covariance of a point is not positive definite");
                small::multiply(root, inverse, factor);
                small::symmetric_product(factor, cloud.scatter, freed);
                const double more = cloud.number - 1;
                known.shape = (known.weight * known.shape + freed) / (known.weight + more);
                known.weight += more;
            }
            write(args.out, i, known);
            if (args.log_likelihood.data != nullptr)
                pelorus::store<1, 1>(args.log_likelihood, i, pelorus::Matrix<1>::Constant(log_likelihood));
        });
    }

    plr_status shape(const plr_call& call, const plr_extent_shape& args) const {
        const std::int64_t count = args.matrix.count;
        pelorus::expect(args.record, info.record_size, 1, count, "record");
        pelorus::expect(args.matrix, dimension, dimension, count, "matrix");
        expect_optional(args.half_axes, dimension, 1, count, "half_axes");
        expect_optional(args.axes, dimension, dimension, count, "axes");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Shape shape = read(args.record, i).shape;
            Point squares, half_axes;
            Shape vectors, axes;
            if (!small::symmetric_eigen(shape, squares, vectors))
                throw pelorus::NumericError("the shape is not finite");
            for (int k = 0; k < dimension; ++k) {  // ascending; descending is wanted
                half_axes(k) = std::sqrt(squares(dimension - 1 - k));
                axes.col(k) = vectors.col(dimension - 1 - k);
            }
            pelorus::store<dimension, dimension>(args.matrix, i, shape);
            if (args.half_axes.data != nullptr) pelorus::store<dimension, 1>(args.half_axes, i, half_axes);
            if (args.axes.data != nullptr) pelorus::store<dimension, dimension>(args.axes, i, axes);
        });
    }

    plr_status gate(const plr_call& call, const plr_extent_gate& args) const {
        const std::int64_t count = args.record.count;
        expect_points(args.scan, count);
        pelorus::expect(args.record, info.record_size, 1, count, "record");
        pelorus::expect(args.predicted, dimension, 1, count, "predicted");
        pelorus::expect(args.covariance, dimension, dimension, count, "covariance");
        pelorus::expect(args.squared_distance, 1, 1, args.scan.offsets[count], "squared_distance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Shape common = read(args.record, i).shape + pelorus::load<dimension, dimension>(args.covariance, i);
            const Point centre = pelorus::load<dimension, 1>(args.predicted, i);
            for (std::int64_t k = args.scan.offsets[i]; k < args.scan.offsets[i + 1]; ++k) {
                Shape root;
                if (!small::cholesky(Shape(common + pelorus::load<dimension, dimension>(args.scan.noise, k)), root))
                    throw pelorus::NumericError("the covariance of a point is not positive definite");
                const Point apart = pelorus::load<dimension, 1>(args.scan.points, k) - centre;
                pelorus::store<1, 1>(args.squared_distance, k,
                                     pelorus::Matrix<1>::Constant(small::inverse_quadratic(root, apart)));
            }
        });
    }

    static Cloud cloud_of(const plr_extent_points& scan, std::int64_t i) {
        Cloud cloud;
        const std::int64_t begin = scan.offsets[i], end = scan.offsets[i + 1];
        if (begin == end) return cloud;
        const auto weight = [&](std::int64_t k) {
            return scan.weights.data == nullptr ? 1 / static_cast<double>(end - begin)
                                                : scan.weights.data[k * scan.weights.item_stride];
        };
        double squares = 0;
        for (std::int64_t k = begin; k < end; ++k) {
            squares += weight(k) * weight(k);
            cloud.centroid += weight(k) * pelorus::load<dimension, 1>(scan.points, k);
            cloud.noise += weight(k) * pelorus::load<dimension, dimension>(scan.noise, k);
        }
        cloud.number = scan.weights.data == nullptr ? static_cast<double>(end - begin) : 1 / squares;
        for (std::int64_t k = begin; k < end; ++k)
            small::add_outer(cloud.number * weight(k),
                             Point(pelorus::load<dimension, 1>(scan.points, k) - cloud.centroid), cloud.scatter);
        return cloud;
    }
    Known read(const plr_const_view& records, std::int64_t i) const {
        const double* record = records.data + i * records.item_stride;
        const Known known{record[0], Eigen::Map<const Shape>(record + 1)};
        if (!std::isfinite(known.weight) || !known.shape.allFinite())
            throw pelorus::NumericError("the record is not finite");
        return known;
    }
    void write(const plr_view& records, std::int64_t i, const Known& known) const {
        Shape root;
        if (!std::isfinite(known.weight) || !small::cholesky(known.shape, root))
            throw pelorus::NumericError("the shape is not finite and positive definite");
        double* record = records.data + i * records.item_stride;
        record[0] = known.weight;
        Eigen::Map<Shape>(record + 1) = known.shape;
    }

    static void expect_points(const plr_extent_points& scan, std::int64_t count) {
        if (scan.offsets == nullptr)
            throw pelorus::ArgumentError("offsets: is NULL, expected one more than there are items");
        const std::int64_t total = scan.offsets[count];
        pelorus::expect(scan.points, dimension, 1, total, "points");
        pelorus::expect(scan.noise, dimension, dimension, total, "noise");
        if (scan.weights.data != nullptr) pelorus::expect(scan.weights, 1, 1, total, "weights");
    }
    static void expect_optional(const plr_view& view, std::int64_t rows, std::int64_t cols, std::int64_t count,
                                const char* what) {
        if (view.data != nullptr) pelorus::expect(view, rows, cols, count, what);
    }
    void expect_records(const plr_const_view& record, const plr_view& out) const {
        pelorus::expect(record, info.record_size, 1, out.count, "record");
        pelorus::expect(out, info.record_size, 1, out.count, "out");
    }

private:
    /// ln of the density of n points about their centroid, each of covariance Y.
    static double log_spread(const Cloud& cloud, const Shape& point) {
        Shape root, scaled = cloud.scatter;
        if (!small::cholesky(point, root))
            throw pelorus::NumericError("the covariance of a point is not positive definite");
        small::cholesky_solve(root, scaled);
        const double log_two_pi = std::log(2 * 3.14159265358979323846);
        return -0.5 * ((cloud.number - 1) * (dimension * log_two_pi + small::log_determinant(root)) +
                       dimension * std::log(cloud.number) + scaled.trace());
    }
    static Shape with_floor(const Shape& matrix, double floor) {
        Point values;
        Shape vectors, scaled, out;
        if (!small::symmetric_eigen(matrix, values, vectors))
            throw pelorus::NumericError("the scatter of the points is not finite");
        for (int k = 0; k < dimension; ++k) scaled.col(k) = vectors.col(k) * std::max(values(k), floor);
        small::multiply_transposed(scaled, vectors, out);
        small::symmetrise(out);
        return out;
    }
};

}  // namespace pelorus::conformance
