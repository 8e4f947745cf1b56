/// extent.random_matrix, update `koch`: kinematics and shape in one record. See README.md.
#pragma once

#include <vector>

#include <pelorus/batch_model.hpp>

#include "random_matrix.hpp"

namespace random_matrix {

/// Koch 2008: P = P1 (x) X. The record: x (c), P1 (b x b, by columns), v, V.
template <int D> class Koch : public pelorus::Extent<Koch<D>>, public Parameters {
public:
    using Shape = InverseWishart<D>;
    static constexpr bool joint = true;
    static constexpr int max_block = 4;  // position, velocity, acceleration, jerk
    using Block = pelorus::small::Bounded<max_block, max_block>;
    using State = pelorus::small::Bounded<D, max_block>;  // one column a derivative
    using Gain = pelorus::small::Bounded<max_block, 1>;

    static void describe(pelorus::Describe<Koch>& plugin) { describe_parameters(plugin); }

    void setup(const pelorus::Setup& setup) {
        if (innovation_spread) throw pelorus::ParameterError("innovation_spread", "is for update: published only");
        motion_ = setup.part<pelorus::MotionPart>("motion");
        structure_ = motion_.template extension<plr_motion_structure>(PLR_MOTION_STRUCTURE);
        if (structure_ == nullptr)
            throw pelorus::PartError("motion", motion_.id() + " does not offer " PLR_MOTION_STRUCTURE
                                                              ": update: koch takes a motion F1 (x) I, Q1 (x) I");
        if (structure_->dimension != D)
            throw pelorus::PartError("motion", "has " + std::to_string(structure_->dimension) +
                                                   " axes, the extent has " + std::to_string(D) + " (dimension)");
        if (structure_->block > max_block)
            throw pelorus::PartError("motion", "has " + std::to_string(structure_->block) + " derivatives, at most " +
                                                   std::to_string(max_block) + " are taken");
        block_ = structure_->block;
        nominal_ = nominal_extent.value_or(50.0);
        for (const auto& sensor : setup.parts<pelorus::SensorPart>("sensors")) {
            sensors_.push_back(sensor.raw());
            sensors_.back().struct_size = sizeof(plr_part);
        }
        space_ = pelorus::Space(*motion_.info().cartesian);
        joint_ = Koch::joint_table(space_.c(), sensors_.data(), static_cast<std::uint32_t>(sensors_.size()));
        this->info.dimension = D;
        this->info.start_scans = start == Start::consistent ? 2 : 1;
        this->info.start_points = random_matrix::start_points<D>(start);
        this->info.record_version = 1;
        this->info.record_size = D * block_ + block_ * block_ + Shape::record_size;
        this->info.scratch_bytes = motion_.info().scratch_bytes;
    }

    const void* extension(const char* id) const noexcept {
        return std::strcmp(id, PLR_EXTENT_JOINT) == 0 ? &joint_ : nullptr;
    }

    plr_status joint_init(const plr_call& call, const plr_joint_init& args) const {
        const std::int64_t count = args.record.count, c = D * block_;
        if (count == 0) return PLR_OK;
        expect_start<D>(args.scan, args.scans, this->info.start_scans, count);
        pelorus::expect(args.mean, c, 1, count, "mean");
        pelorus::expect(args.record, this->info.record_size, 1, count, "record");
        if (args.covariance.data != nullptr) {
            pelorus::expect(args.covariance, c, c, count, "covariance");
        } else if (start == Start::published) {
            throw pelorus::ArgumentError("covariance: is missing; only a start from two scans implies one");
        } else {
            pelorus::expect(args.times, 2, 1, 1, "times");
        }
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            Item item = blank();
            for (std::int64_t k = 0; k < c; ++k) item.state.data()[k] = args.mean.data[i * args.mean.item_stride + k];
            item.shape = begin_shape<D>(start, lambda, args.scan, i);
            if (args.covariance.data != nullptr) {
                item.spread = block_traces(pelorus::slice(args.covariance, i, 1));
            } else {
                const std::int64_t points = args.scan[1].offsets[i + 1] - args.scan[1].offsets[i];
                item.spread = differenced(args.times.data[args.times.row_stride] - args.times.data[0],
                                          static_cast<double>(points));
            }
            write(item, args.record, i);
        });
    }

    plr_status joint_predict(const plr_call& call, const plr_joint_predict& args) const {
        const std::int64_t count = args.out.count;
        pelorus::expect(args.dt, 1, 1, count, "dt");
        expect_records(args.record, args.out);
        Block transition(block_, block_), noise(block_, block_);
        double blocks_of = -1;  // the dt that the two are for
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const double dt = args.dt.data[i * args.dt.item_stride];
            Item item = read(args.record, i);
            item.shape.forget(decay, dt);
            if (dt > 0) {  // dt = 0 must not add the noise of a step
                if (dt != blocks_of) {
                    pelorus::require(structure_->blocks(motion_.self(), &call, dt, transition.data(), noise.data()));
                    blocks_of = dt;
                }
                State moved(D, block_);
                Block spread(block_, block_);
                pelorus::small::multiply_transposed(item.state, transition, moved);
                pelorus::small::symmetric_product(transition, item.spread, spread);
                item.state = moved;
                item.spread = spread + noise / nominal_;
            }
            write(item, args.out, i);
        });
    }

    plr_status joint_update(const plr_call& call, const plr_joint_update& args) const {
        const std::int64_t count = args.out.count;
        expect_points<D>(args.scan, count);
        expect_records(args.record, args.out);
        if (args.log_likelihood.data != nullptr) pelorus::expect(args.log_likelihood, 1, 1, count, "log_likelihood");
        if (args.innovation.data != nullptr) pelorus::expect(args.innovation, D, 1, count, "innovation");
        if (args.innovation_covariance.data != nullptr)
            pelorus::expect(args.innovation_covariance, D, D, count, "innovation_covariance");
        return pelorus::for_items(call, count, [&](std::int64_t i) { update_item(args, i); });
    }

    plr_status joint_summary(const plr_call& call, const plr_joint_summary& args) const {
        const std::int64_t count = args.mean.count, c = D * block_;
        pelorus::expect(args.record, this->info.record_size, 1, count, "record");
        pelorus::expect(args.mean, c, 1, count, "mean");
        if (args.covariance.data != nullptr) pelorus::expect(args.covariance, c, c, count, "covariance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Item item = read(args.record, i);
            const Matrix<D> extent = item.shape.extent();
            // The largest product, too: what is finite in the record may not be so in the covariance.
            if (!pelorus::small::all_finite(item.state) || !pelorus::small::all_finite(item.spread) ||
                !std::isfinite(item.spread.cwiseAbs().maxCoeff() * extent.cwiseAbs().maxCoeff()) || !extent.allFinite())
                throw pelorus::NumericError("the record is not finite");
            double* mean = args.mean.data + i * args.mean.item_stride;
            for (std::int64_t k = 0; k < c; ++k) mean[k] = item.state.data()[k];
            if (args.covariance.data == nullptr) return;
            double* covariance = args.covariance.data + i * args.covariance.item_stride;
            for (std::int64_t col = 0; col < c; ++col)
                for (std::int64_t row = 0; row < c; ++row)
                    covariance[col * args.covariance.col_stride + row] =
                        item.spread(row / D, col / D) * extent(row % D, col % D);
        });
    }

    plr_status joint_gate(const plr_call& call, const plr_extent_gate& args) const {
        const std::int64_t count = args.record.count;
        expect_points<D>(args.scan, count);
        pelorus::expect(args.record, this->info.record_size, 1, count, "record");
        pelorus::expect(args.squared_distance, 1, 1, args.scan.offsets[count], "squared_distance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Item item = read(args.record, i);
            const Matrix<D> common = (item.spread(0, 0) + lambda) * item.shape.extent();
            store_distances<D>(args.scan, i, Vector<D>(item.state.col(0)), common, args.squared_distance);
        });
    }

    plr_status shape(const plr_call& call, const plr_extent_shape& args) const {
        const std::int64_t count = args.matrix.count;
        pelorus::expect(args.record, this->info.record_size, 1, count, "record");
        expect_shape<D>(args);
        return pelorus::for_items(
            call, count, [&](std::int64_t i) { store_shape<D>(read(args.record, i).shape.extent(), args, i); });
    }

private:
    struct Item {
        State state;   ///< D x b
        Block spread;  ///< P1, b x b
        Shape shape;
    };
    Item blank() const { return {State::Zero(D, block_), Block::Zero(block_, block_), Shape{}}; }
    Item read(const plr_const_view& records, std::int64_t i) const {
        const double* at = records.data + i * records.item_stride;
        Item item = blank();
        for (int k = 0; k < D * block_; ++k) item.state.data()[k] = *at++;
        for (int k = 0; k < block_ * block_; ++k) item.spread.data()[k] = *at++;
        item.shape = Shape::read(at);
        return item;
    }
    /// Throws NumericError where something is not finite or the shape is not positive definite.
    void write(const Item& item, const plr_view& records, std::int64_t i) const {
        if (!pelorus::small::all_finite(item.state) || !pelorus::small::all_finite(item.spread))
            throw pelorus::NumericError("the kinematics are no longer finite");
        double* at = records.data + i * records.item_stride;
        for (int k = 0; k < D * block_; ++k) *at++ = item.state.data()[k];
        for (int k = 0; k < block_ * block_; ++k) *at++ = item.spread.data()[k];
        item.shape.write(at);
    }
    void expect_records(const plr_const_view& record, const plr_view& out) const {
        pelorus::expect(record, this->info.record_size, 1, out.count, "record");
        pelorus::expect(out, this->info.record_size, 1, out.count, "out");
    }

    /// P1 of a full covariance: mean of each block's diagonal, over the nominal extent.
    Block block_traces(const plr_const_view& covariance) const {
        Block out = Block::Zero(block_, block_);
        for (int col = 0; col < block_; ++col)
            for (int row = 0; row < block_; ++row)
                for (int axis = 0; axis < D; ++axis)
                    out(row, col) +=
                        covariance.data[(col * D + axis) * covariance.col_stride + row * D + axis] / (D * nominal_);
        return out;
    }
    /// P1 of a start by differencing two centroids of covariance lambda X / n; higher derivatives by their prior deviation.
    Block differenced(double dt, double points) const {
        if (!(dt > 0)) throw pelorus::ArgumentError("times: must ascend");
        Block out = Block::Zero(block_, block_);
        for (int k = 2; k < block_; ++k) {
            const double deviation = space_[k * D].prior_deviation;
            out(k, k) = deviation * deviation / nominal_;
        }
        out(0, 0) = lambda / points;
        if (block_ < 2) return out;
        out(0, 1) = out(1, 0) = out(0, 0) / dt;
        out(1, 1) = 2.0 * out(0, 0) / (dt * dt);
        return out;
    }

    void update_item(const plr_joint_update& args, std::int64_t i) const {
        Item item = read(args.record, i);
        const Scatter<D> scatter = scatter_of<D>(args.scan, i);
        const Matrix<D> extent = item.shape.extent();
        Vector<D> innovation = Vector<D>::Zero();
        Matrix<D> covariance = extent * item.spread(0, 0);
        double log_likelihood = 0;
        if (scatter.points > 0) {
            const double noise = lambda / scatter.number, scale = item.spread(0, 0) + noise;
            innovation = scatter.centroid - item.state.col(0);
            covariance = extent * scale;
            correct(item, innovation, scale, noise);
            item.shape.degrees += scatter.number;
            pelorus::small::add_outer(1.0 / scale, innovation, item.shape.scale);
            item.shape.scale += scatter.sum / lambda;
            if (args.log_likelihood.data != nullptr)
                log_likelihood =
                    log_normal(innovation, covariance) + log_spread<D>(scatter, Matrix<D>(lambda * extent));
        }
        write(item, args.out, i);
        if (args.log_likelihood.data != nullptr)
            pelorus::store<1, 1>(args.log_likelihood, i, Matrix<1>::Constant(log_likelihood));
        if (args.innovation.data != nullptr) pelorus::store<D, 1>(args.innovation, i, innovation);
        if (args.innovation_covariance.data != nullptr) pelorus::store<D, D>(args.innovation_covariance, i, covariance);
    }

    /// x += e K', P1 in Joseph's form, with K = P1[:, p]/s and H = [1 0 ..].
    void correct(Item& item, const Vector<D>& innovation, double scale, double noise) const {
        const Gain gain = item.spread.col(0) / scale;
        for (int k = 0; k < block_; ++k) item.state.col(k) += gain(k) * innovation;
        Block rest = Block::Identity(block_, block_), spread(block_, block_);
        rest.col(0) -= gain;
        pelorus::small::symmetric_product(rest, item.spread, spread);
        pelorus::small::add_outer(noise, gain, spread);
        item.spread = spread;
    }

    pelorus::MotionPart motion_;
    const plr_motion_structure* structure_ = nullptr;
    int block_ = 0;
    double nominal_ = 50;
    pelorus::Space space_;
    std::vector<plr_part> sensors_;
    plr_extent_joint joint_{};
};

}  // namespace random_matrix
