/// extent.random_matrix, update `published` and `feldmann`: an inverse-Wishart extent beside an estimator. See README.md.
#pragma once

#include "../../common/random_matrix/feldmann.hpp"
#include "parameters.hpp"

namespace random_matrix {

/// The random matrix beside an estimator.
template <int D> class RandomMatrix : public pelorus::Extent<RandomMatrix<D>>, public Parameters {
public:
    using Shape = InverseWishart<D>;

    static void describe(pelorus::Describe<RandomMatrix>& plugin) { describe_parameters(plugin); }

    void setup(const pelorus::Setup& setup) {
        for (const char* slot : {"motion", "sensors"})
            if (!setup.parts<pelorus::Part<plr_motion>>(slot).empty())
                throw pelorus::PartError(slot,
                                         "is for update: koch, lan_li or variational; with this update the estimator "
                                         "beside the extent has it");
        if (nominal_extent) throw pelorus::ParameterError("nominal_extent", "is for update: koch or lan_li only");
        if (innovation_spread && rule != Rule::published)
            throw pelorus::ParameterError("innovation_spread", "is for update: published only");
        this->info.dimension = D;
        this->info.start_scans = start == Start::consistent ? 2 : 1;
        this->info.start_points = random_matrix::start_points<D>(start);
        this->info.record_version = Shape::record_version;
        this->info.record_size = Shape::record_size;
    }

    plr_status init(const plr_call& call, const plr_extent_init& args) const {
        const std::int64_t count = args.record.count;
        expect_start<D>(args.scan, args.scans, this->info.start_scans, count);
        pelorus::expect(args.record, Shape::record_size, 1, count, "record");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            begin_shape<D>(start, lambda, args.scan, i).write(args.record.data + i * args.record.item_stride);
        });
    }

    plr_status predict(const plr_call& call, const plr_extent_predict& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.dt, 1, 1, count, "dt");
        expect_records(args.record, args.out);
        if (follow_velocity && count > 0) expect_velocities<D>(args);
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            Shape shape = shape_of(args.record, i);
            const Vector<D> none = Vector<D>::Zero();
            step<D>(shape, args.dt.data[i * args.dt.item_stride],
                    follow_velocity ? velocity_of<D>(args.before, i) : none,
                    follow_velocity ? velocity_of<D>(args.after, i) : none);
            shape.write(args.out.data + i * args.out.item_stride);
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
            const Matrix<D> point =
                point_covariance(shape_of(args.record, i).extent(), pelorus::load<D, D>(args.noise, i));
            pelorus::store<D, D>(args.out, i, Matrix<D>(point / number));
        });
    }

    plr_status update(const plr_call& call, const plr_extent_update& args) const {
        const std::int64_t count = args.out.count;
        expect_points<D>(args.scan, count);
        pelorus::expect(args.innovation, D, 1, count, "innovation");
        pelorus::expect(args.innovation_covariance, D, D, count, "innovation_covariance");
        expect_records(args.record, args.out);
        if (args.log_likelihood.data != nullptr) pelorus::expect(args.log_likelihood, 1, 1, count, "log_likelihood");
        return pelorus::for_items(call, count, [&](std::int64_t i) { update_item(args, i); });
    }

    plr_status shape(const plr_call& call, const plr_extent_shape& args) const {
        const std::int64_t count = args.matrix.count;
        pelorus::expect(args.record, Shape::record_size, 1, count, "record");
        expect_shape<D>(args);
        return pelorus::for_items(call, count,
                                  [&](std::int64_t i) { store_shape<D>(shape_of(args.record, i).extent(), args, i); });
    }

    plr_status gate(const plr_call& call, const plr_extent_gate& args) const {
        const std::int64_t count = args.record.count;
        expect_points<D>(args.scan, count);
        pelorus::expect(args.record, Shape::record_size, 1, count, "record");
        pelorus::expect(args.predicted, D, 1, count, "predicted");
        pelorus::expect(args.covariance, D, D, count, "covariance");
        pelorus::expect(args.squared_distance, 1, 1, args.scan.offsets[count], "squared_distance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Matrix<D> common =
                lambda * shape_of(args.record, i).extent() + pelorus::load<D, D>(args.covariance, i);
            const Vector<D> centre = pelorus::load<D, 1>(args.predicted, i);
            store_distances<D>(args.scan, i, centre, common, args.squared_distance);
        });
    }

private:
    static Shape shape_of(const plr_const_view& record, std::int64_t i) {
        return Shape::read(record.data + i * record.item_stride);
    }
    static void expect_records(const plr_const_view& record, const plr_view& out) {
        pelorus::expect(record, Shape::record_size, 1, out.count, "record");
        pelorus::expect(out, Shape::record_size, 1, out.count, "out");
    }
    Matrix<D> point_covariance(const Matrix<D>& extent, const Matrix<D>& noise) const {
        return lambda * extent + noise;
    }

    void update_item(const plr_extent_update& args, std::int64_t i) const {
        Shape shape = shape_of(args.record, i);
        const Scatter<D> scatter = scatter_of<D>(args.scan, i);
        double log_likelihood = 0;
        if (scatter.points > 0) {
            const Matrix<D> predicted = shape.extent();
            const Matrix<D> point = point_covariance(predicted, scatter.noise);
            const Vector<D> innovation = pelorus::load<D, 1>(args.innovation, i);
            const Matrix<D> covariance = pelorus::load<D, D>(args.innovation_covariance, i);
            if (rule == Rule::feldmann)
                update_feldmann<D>(shape, predicted, point, scatter, innovation, covariance);
            else
                update_published(shape, predicted, scatter, innovation, covariance);
            if (args.log_likelihood.data != nullptr) log_likelihood = log_spread(scatter, point);
        }
        shape.write(args.out.data + i * args.out.item_stride);
        if (args.log_likelihood.data != nullptr)
            pelorus::store<1, 1>(args.log_likelihood, i, Matrix<1>::Constant(log_likelihood));
    }

    void update_published(Shape& shape, const Matrix<D>& predicted, const Scatter<D>& scatter,
                          const Vector<D>& innovation, const Matrix<D>& covariance) const {
        const InnovationSpread reading = innovation_spread.value_or(InnovationSpread::trace);
        shape.degrees += scatter.number;
        shape.scale += innovation_share(reading, predicted, innovation, covariance) + scatter.sum;
        pelorus::small::symmetrise(shape.scale);
        // The symmetrised print is indefinite: a large innovation could turn the scale so, too.
        if (reading == InnovationSpread::symmetrised)
            shape.scale = with_floor<D>(shape.scale, least_relative_eigenvalue * shape.scale.trace() / D);
    }

    /// N, in m^2 (the symmetrised print: a pure number that is added as m^2).
    static Matrix<D> innovation_share(InnovationSpread reading, const Matrix<D>& predicted, const Vector<D>& innovation,
                                      const Matrix<D>& covariance) {
        const Matrix<D> outer = innovation * innovation.transpose();
        switch (reading) {
            case InnovationSpread::trace:
                return outer * (predicted.trace() / covariance.trace());
            case InnovationSpread::symmetrised: {
                Matrix<D> root, solved = outer;
                if (!pelorus::small::cholesky(covariance, root)) throw not_definite();
                pelorus::small::cholesky_solve(root, solved);
                return 0.5 * (solved + solved.transpose());
            }
            case InnovationSpread::feldmann:
                return whitened<D>(predicted, covariance, outer);
        }
        return Matrix<D>::Zero();
    }

    static constexpr double least_relative_eigenvalue = 1e-3;
};

}  // namespace random_matrix
