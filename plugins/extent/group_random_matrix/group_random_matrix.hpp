/// extent.group_random_matrix: the shape of a group as an inverse-Wishart matrix beside an estimator. See README.md.
#pragma once

#include <pelorus/batch_model.hpp>

#include "../../common/random_matrix/feldmann.hpp"
#include "evolution.hpp"

namespace group_random_matrix {

using pelorus::Matrix;
using pelorus::Vector;
using random_matrix::InverseWishart;
using random_matrix::Scatter;

enum class Evolution { moments, printed };

struct Parameters {
    int dimension = 3;
    double lambda = 0.25;
    Evolution evolution = Evolution::moments;
    double degrees = 5;
    double step = 1;                ///< s
    double start_certainty = 3;     ///< l of a start
    double smallest_half_axis = 0;  ///< m
};

template <int D> class GroupRandomMatrix : public pelorus::Extent<GroupRandomMatrix<D>>, public Parameters {
public:
    using Shape = InverseWishart<D>;

    static void describe(pelorus::Describe<GroupRandomMatrix>& plugin);

    void setup(const pelorus::Setup&) {
        this->info.dimension = D;
        this->info.start_scans = 1;
        this->info.start_points = 1;
        this->info.record_version = Shape::record_version;
        this->info.record_size = Shape::record_size;
    }

    /// X0 = scatter/n + (smallest half axis)^2 I, so that a single point makes a shape, too.
    plr_status init(const plr_call& call, const plr_extent_init& args) const {
        const std::int64_t count = args.record.count;
        random_matrix::expect_start<D>(args.scan, args.scans, this->info.start_scans, count);
        pelorus::expect(args.record, Shape::record_size, 1, count, "record");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Spread spread = spread_of(args.scan[0], i);
            if (spread.points < 1) throw pelorus::NumericError("the shape starts with at least 1 point, got 0");
            // Without a smallest half axis a group of few points would have no extent along some axis.
            const double least =
                smallest_half_axis > 0 ? smallest_half_axis * smallest_half_axis : least_share * spread.noise.trace();
            const Matrix<D> extent = spread.sum / spread.number + least * Matrix<D>::Identity();
            of(extent, start_certainty).write(args.record.data + i * args.record.item_stride);
        });
    }

    plr_status predict(const plr_call& call, const plr_extent_predict& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.dt, 1, 1, count, "dt");
        expect_records(args.record, args.out);
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const double dt = args.dt.data[i * args.dt.item_stride];
            if (dt < 0) throw pelorus::UnsupportedError("cannot move backward in time (dt < 0)");
            const Shape before = shape_of(args.record, i);
            Shape after = before;
            if (dt != 0) after = of(before.extent(), evolved(certainty(before), dt / step));
            after.age = before.age + dt;
            after.write(args.out.data + i * args.out.item_stride);
        });
    }

    plr_status effective_noise(const plr_call& call, const plr_extent_effective_noise& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.record, Shape::record_size, 1, count, "record");
        pelorus::expect(args.noise, D, D, count, "noise");
        pelorus::expect(args.number, 1, 1, count, "number");
        pelorus::expect(args.out, D, D, count, "out");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const double number = args.number.data[i * args.number.item_stride];
            if (!(number > 0)) throw pelorus::ArgumentError("number: must be above 0");
            const Matrix<D> point = lambda * shape_of(args.record, i).extent() + pelorus::load<D, D>(args.noise, i);
            pelorus::store<D, D>(args.out, i, Matrix<D>(point / number));
        });
    }

    plr_status update(const plr_call& call, const plr_extent_update& args) const {
        const std::int64_t count = args.out.count;
        random_matrix::expect_points<D>(args.scan, count);
        pelorus::expect(args.innovation, D, 1, count, "innovation");
        pelorus::expect(args.innovation_covariance, D, D, count, "innovation_covariance");
        expect_records(args.record, args.out);
        if (args.log_likelihood.data != nullptr) pelorus::expect(args.log_likelihood, 1, 1, count, "log_likelihood");
        return pelorus::for_items(call, count, [&](std::int64_t i) { update_item(args, i); });
    }

    plr_status shape(const plr_call& call, const plr_extent_shape& args) const {
        const std::int64_t count = args.matrix.count;
        pelorus::expect(args.record, Shape::record_size, 1, count, "record");
        random_matrix::expect_shape<D>(args);
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            random_matrix::store_shape<D>(shape_of(args.record, i).extent(), args, i);
        });
    }

    plr_status gate(const plr_call& call, const plr_extent_gate& args) const {
        const std::int64_t count = args.record.count;
        random_matrix::expect_points<D>(args.scan, count);
        pelorus::expect(args.record, Shape::record_size, 1, count, "record");
        pelorus::expect(args.predicted, D, 1, count, "predicted");
        pelorus::expect(args.covariance, D, D, count, "covariance");
        pelorus::expect(args.squared_distance, 1, 1, args.scan.offsets[count], "squared_distance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Matrix<D> common =
                lambda * shape_of(args.record, i).extent() + pelorus::load<D, D>(args.covariance, i);
            const Vector<D> centre = pelorus::load<D, 1>(args.predicted, i);
            random_matrix::store_distances<D>(args.scan, i, centre, common, args.squared_distance);
        });
    }

private:
    using Spread = Scatter<D>;
    static constexpr double least_share = 1e-6;  ///< of the noise's trace

    static double certainty(const Shape& shape) { return shape.degrees - (2 * D + 2); }
    static Shape of(const Matrix<D>& extent, double certainty) {
        Shape out;
        out.degrees = 2 * D + 2 + certainty;
        out.scale = certainty * extent;
        return out;
    }
    double evolved(double certainty, double steps) const {
        return evolution == Evolution::moments ? evolved_by_moments(certainty, degrees, steps)
                                               : evolved_as_printed(certainty, degrees);
    }
    static Shape shape_of(const plr_const_view& record, std::int64_t i) {
        return Shape::read(record.data + i * record.item_stride);
    }
    static void expect_records(const plr_const_view& record, const plr_view& out) {
        pelorus::expect(record, Shape::record_size, 1, out.count, "record");
        pelorus::expect(out, Shape::record_size, 1, out.count, "out");
    }

    /// Weights move the centre; each point counts once in what the group is as large as.
    static Spread spread_of(const plr_extent_points& scan, std::int64_t i) {
        Spread out = random_matrix::scatter_of<D>(scan, i);
        if (scan.weights.data == nullptr || out.points == 0) return out;
        out.number = static_cast<double>(out.points);
        out.sum.setZero();
        for (std::int64_t k = scan.offsets[i]; k < scan.offsets[i + 1]; ++k)
            pelorus::small::add_outer(1.0, Vector<D>(pelorus::load<D, 1>(scan.points, k) - out.centroid), out.sum);
        return out;
    }

    void update_item(const plr_extent_update& args, std::int64_t i) const {
        Shape shape = shape_of(args.record, i);
        const Spread spread = spread_of(args.scan, i);
        double log_likelihood = 0;
        if (spread.points > 0) {
            const Matrix<D> predicted = shape.extent();
            const Matrix<D> point = lambda * predicted + spread.noise;
            const Matrix<D> innovation = lambda * predicted + pelorus::load<D, D>(args.innovation_covariance, i);
            random_matrix::update_feldmann<D>(shape, predicted, point, spread, pelorus::load<D, 1>(args.innovation, i),
                                              innovation);
            if (smallest_half_axis > 0)
                shape.scale = random_matrix::with_floor<D>(shape.scale,
                                                           certainty(shape) * smallest_half_axis * smallest_half_axis);
            if (args.log_likelihood.data != nullptr) log_likelihood = random_matrix::log_spread(spread, point);
        }
        shape.write(args.out.data + i * args.out.item_stride);
        if (args.log_likelihood.data != nullptr)
            pelorus::store<1, 1>(args.log_likelihood, i, Matrix<1>::Constant(log_likelihood));
    }
};

template <int D> void GroupRandomMatrix<D>::describe(pelorus::Describe<GroupRandomMatrix>& plugin) {
    plugin.title("Random matrix of a group")
        .purpose(
            "The shape of a group of objects as an ellipsoid whose squared half axes are the eigenvalues of a random "
            "matrix, learned from where the members are and from how far their centre is from where it was expected. "
            "It starts from one scan, of a single member if need be, and never gets smaller than a smallest half axis. "
            "Stands beside an estimator.")
        .equation(
            "l' = l (delta + 2)/(l + delta) a step, X' = X; v = v' + n, V = l' X' + y y' + B^-1 Z B^-T, y = X'^1/2 (S "
            "+ lambda X')^-1/2 e, B = (lambda X' + R)^1/2 X'^-1/2; X = V/l, l = v - 2d - 2")
        .source(
            "W. Koch, Bayesian approach to extended object and cluster tracking using random matrices, IEEE "
            "Transactions on Aerospace and Electronic Systems 44(3), 2008; M. Feldmann, D. Fraenken, W. Koch, Tracking "
            "of extended objects and group targets using random matrices, IEEE Transactions on Signal Processing "
            "59(4), 2011; J. Lan, X. R. Li, Tracking of extended object or target group using random matrix - part I: "
            "new model and approach, FUSION 2012; Han, Zhou, Journal of Ordnance Equipment Engineering 41(12), 2020");
    plugin.parameter("lambda", &Parameters::lambda)
        .initially("0.25")
        .above(0)
        .doc("covariance of members over the extent matrix: 1/4 puts the outline at two deviations, 1 at one");
    plugin.parameter("evolution", &Parameters::evolution)
        .initially("moments")
        .choices({{"moments", "the mean stays and the second moment is matched; a long step is many short ones"},
                  {"printed",
                   "Han and Zhou 2020: l' = 2 + 2 delta (l + 1)(l - 1)(l - 2)/(l^2 (l + delta)), once a step "
                   "of whatever length"}})
        .doc("how what is known of the shape fades");
    plugin.parameter("evolution_degrees", &Parameters::degrees)
        .initially("5")
        .above(0)
        .doc("delta: the smaller it is, the faster it fades");
    plugin.parameter("evolution_step", &Parameters::step)
        .unit("s")
        .initially("1 s")
        .above(0)
        .doc("time that delta holds for; evolution: moments");
    plugin.parameter("start_certainty", &Parameters::start_certainty)
        .initially("3")
        .min(least_certainty)
        .doc("l of a start; below 2 it would grow by itself");
    plugin.parameter("smallest_half_axis", &Parameters::smallest_half_axis)
        .unit("m")
        .initially("10 m")
        .min(0)
        .doc("no half axis gets smaller; a start adds its square on each axis");
    plugin.parameter("dimension", &Parameters::dimension).initially("3").min(2).max(3).doc("axes: x, y[, z]");
}

}  // namespace group_random_matrix
