/// What both ways of extent.velocity_aligned share: a random matrix of Feldmann's with a consistent start beneath, and a second
/// estimate of the shape that knows where the target flies. See README.md.
///
/// The record: the random matrix, then what the Method keeps in its Memory. A Method has static functions, which get the
/// parameters first:
///     void start(memory, scans, i)
///     void turn(memory, args, i, random)                the step; `random` has been predicted already
///     void learn(memory, args, i, scatter, random)      a scan's points; `random` has been updated already
///     Matrix<D> shape_of(memory, random)                what is told
///     Matrix<D> noise_shape_of(memory, random)          what the centroid's noise is made of
#pragma once

#include <pelorus/batch_model.hpp>

#include "../../common/random_matrix/direction.hpp"
#include "../../common/random_matrix/feldmann.hpp"
#include "../../common/random_matrix/spread_parameter.hpp"

namespace velocity_aligned {

using namespace random_matrix;

enum class Weighing { none, covariance };

struct Parameters {
    Weighing weighing = Weighing::none;
    double lambda = 1;
    double decay = 0.1;      // 1/s
    double memory = 100;     // s
    double align_after = 2;  // s
    int dimension = 3;
};

template <class Plugin> void describe_parameters(pelorus::Describe<Plugin>& plugin) {
    plugin.title("Extent along the velocity")
        .purpose(
            "The shape of a target that keeps its attitude to its velocity, as ships and aircraft do: scatter is "
            "collected in a frame that turns with the velocity, so that it needs not be forgotten as fast as a random "
            "matrix must be that knows nothing of turns. Beside it a random matrix is kept, which takes over where the "
            "velocity's direction is not known.")
        .equation(
            "none: X = a uu' + b (I - uu'), u = v/|v|, a and b the mean squares of all points along and across u, less "
            "R. covariance: X = (1 - w) F + w G, F a random matrix, G the scatter turned with v, w = s_F^2/(s_F^2 + "
            "s_G^2) from the variances of the directions of both")
        .source(
            "M. Feldmann, D. Fraenken, W. Koch, Tracking of extended objects and group targets using random matrices, "
            "IEEE Transactions on Signal Processing 59(4), 2011 (the random matrix); W. James, C. Stein, Estimation "
            "with quadratic loss, Fourth Berkeley Symposium, 1961 (how far a turn is believed)");
    plugin.parameter("weighing", &Parameters::weighing)
        .initially("none")
        .choices({{"none", "the main axis is the direction of the velocity, however well that is known"},
                  {"covariance", "weighed against a random matrix by the covariance of the velocity"}})
        .doc("whether the direction of the velocity is taken as it is");
    random_matrix::describe_lambda(plugin, &Parameters::lambda);
    plugin.parameter("decay", &Parameters::decay)
        .unit("1/s")
        .initially("0.1 1/s")
        .min(0)
        .doc("rate at which the random matrix forgets");
    plugin.parameter("memory", &Parameters::memory)
        .unit("s")
        .initially("100 s")
        .above(0)
        .doc("weighing covariance: how long scatter that turns with the velocity is remembered");
    plugin.parameter("align_after", &Parameters::align_after)
        .unit("s")
        .initially("2 s")
        .min(0)
        .doc(
            "weighing none: points are collected from so long after the start on; until then the random matrix is "
            "told");
    plugin.parameter("dimension", &Parameters::dimension).initially("3").min(2).max(3).doc("axes: x, y[, z]");
}

template <class Method, int D> class Aligned : public pelorus::Extent<Aligned<Method, D>>, public Parameters {
public:
    using Shape = InverseWishart<D>;

    static void describe(pelorus::Describe<Aligned>& plugin) { describe_parameters(plugin); }

    void setup(const pelorus::Setup&) {
        this->info.dimension = D;
        this->info.start_scans = 2;
        this->info.start_points = start_points<D>(Start::consistent);
        this->info.record_version = Shape::record_version;
        this->info.record_size = record_size();
    }

    plr_status init(const plr_call& call, const plr_extent_init& args) const {
        const std::int64_t count = args.record.count;
        expect_start<D>(args.scan, args.scans, this->info.start_scans, count);
        pelorus::expect(args.record, record_size(), 1, count, "record");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            Item item{begin_shape<D>(Start::consistent, lambda, args.scan, i), {}};
            Method::start(*this, item.memory, args.scan, i);
            write(item, args.record, i);
        });
    }

    plr_status predict(const plr_call& call, const plr_extent_predict& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.dt, 1, 1, count, "dt");
        expect_records(args.record, args.out);
        if (count > 0) expect_velocities<D>(args);
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            Item item = read(args.record, i);
            const double dt = args.dt.data[i * args.dt.item_stride];
            item.random.forget(decay, dt);
            if (dt > 0) Method::turn(*this, item.memory, args, i, item.random);
            write(item, args.out, i);
        });
    }

    plr_status effective_noise(const plr_call& call, const plr_extent_effective_noise& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.record, record_size(), 1, count, "record");
        pelorus::expect(args.noise, D, D, count, "noise");
        pelorus::expect(args.number, 1, 1, count, "number");
        pelorus::expect(args.out, D, D, count, "out");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const double number = args.number.data[i * args.number.item_stride];
            if (!(number > 0)) throw pelorus::ArgumentError("number: must be above 0");
            const Item item = read(args.record, i);
            const Matrix<D> point =
                lambda * Method::noise_shape_of(*this, item.memory, item.random) + pelorus::load<D, D>(args.noise, i);
            pelorus::store<D, D>(args.out, i, Matrix<D>(point / number));
        });
    }

    plr_status update(const plr_call& call, const plr_extent_update& args) const {
        const std::int64_t count = args.out.count;
        expect_points<D>(args.scan, count);
        pelorus::expect(args.innovation, D, 1, count, "innovation");
        pelorus::expect(args.innovation_covariance, D, D, count, "innovation_covariance");
        if (count > 0) expect_velocities<D>(args.kinematics, count, "kinematics");
        if (args.kinematics_covariance.data != nullptr)
            pelorus::expect(args.kinematics_covariance, args.kinematics.rows, args.kinematics.rows, count,
                            "kinematics_covariance");
        expect_records(args.record, args.out);
        if (args.log_likelihood.data != nullptr) pelorus::expect(args.log_likelihood, 1, 1, count, "log_likelihood");
        return pelorus::for_items(call, count, [&](std::int64_t i) { update_item(args, i); });
    }

    plr_status shape(const plr_call& call, const plr_extent_shape& args) const {
        const std::int64_t count = args.matrix.count;
        pelorus::expect(args.record, record_size(), 1, count, "record");
        expect_shape<D>(args);
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Item item = read(args.record, i);
            store_shape<D>(Method::shape_of(*this, item.memory, item.random), args, i);
        });
    }

    plr_status gate(const plr_call& call, const plr_extent_gate& args) const {
        const std::int64_t count = args.record.count;
        expect_points<D>(args.scan, count);
        pelorus::expect(args.record, record_size(), 1, count, "record");
        pelorus::expect(args.predicted, D, 1, count, "predicted");
        pelorus::expect(args.covariance, D, D, count, "covariance");
        pelorus::expect(args.squared_distance, 1, 1, args.scan.offsets[count], "squared_distance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Item item = read(args.record, i);
            const Matrix<D> common = lambda * Method::noise_shape_of(*this, item.memory, item.random) +
                                     pelorus::load<D, D>(args.covariance, i);
            store_distances<D>(args.scan, i, pelorus::load<D, 1>(args.predicted, i), common, args.squared_distance);
        });
    }

private:
    struct Item {
        Shape random;
        typename Method::Memory memory;
    };
    static constexpr std::int64_t record_size() { return Shape::record_size + Method::Memory::size; }
    static Item read(const plr_const_view& records, std::int64_t i) {
        const double* const at = records.data + i * records.item_stride;
        Item item{Shape::read(at), {}};
        std::copy_n(at + Shape::record_size, Method::Memory::size, item.memory.numbers);
        return item;
    }
    /// Throws NumericError where something is not finite or the random matrix is not positive definite.
    static void write(const Item& item, const plr_view& records, std::int64_t i) {
        double* const at = records.data + i * records.item_stride;
        for (const double number : item.memory.numbers)
            if (!std::isfinite(number)) throw pelorus::NumericError("what is known of the shape is no longer finite");
        item.random.write(at);
        std::copy_n(item.memory.numbers, Method::Memory::size, at + Shape::record_size);
    }
    static void expect_records(const plr_const_view& record, const plr_view& out) {
        pelorus::expect(record, record_size(), 1, out.count, "record");
        pelorus::expect(out, record_size(), 1, out.count, "out");
    }

    void update_item(const plr_extent_update& args, std::int64_t i) const {
        Item item = read(args.record, i);
        const Scatter<D> scatter = scatter_of<D>(args.scan, i);
        double log_likelihood = 0;
        if (scatter.points > 0) {
            const Matrix<D> extent = item.random.extent();
            const Matrix<D> point = lambda * extent + scatter.noise;
            update_feldmann<D>(item.random, extent, point, scatter, pelorus::load<D, 1>(args.innovation, i),
                               pelorus::load<D, D>(args.innovation_covariance, i));
            Method::learn(*this, item.memory, args, i, scatter, item.random);
            log_likelihood = log_spread(scatter, point);
        }
        write(item, args.out, i);
        if (args.log_likelihood.data != nullptr)
            pelorus::store<1, 1>(args.log_likelihood, i, Matrix<1>::Constant(log_likelihood));
    }
};

}  // namespace velocity_aligned
