/// What the updates of extent.random_matrix share that keep kinematics and shape in one record. See README.md.
///
/// The record: x (c), the spread of the kinematics (s x s, by columns), the shape. Derived says what the spread is:
///     int spread_size() const                                             s
///     Spread spread_of(covariance, i) const                               of the covariance that a start is given
///     Spread differenced(shape, dt, number, noise) const                  of a start by differencing two centroids
///     Spread moved(spread, F1, Q1) const                                  after a step
///     void correct(item, scatter, told) const                             the update by a scan's points
///     double covariance(item, extent, row, col) const                     an element of the kinematics' covariance
#pragma once

#include <cstring>
#include <vector>

#include "../../common/random_matrix/scatter.hpp"
#include "parameters.hpp"

namespace random_matrix {

constexpr int max_block = 4;  // position, velocity, acceleration, jerk

/// What an update tells besides the new record.
template <int D> struct Told {
    Vector<D> innovation = Vector<D>::Zero();
    Matrix<D> covariance = Matrix<D>::Zero();
    double log_likelihood = 0;
};

template <class Derived, int D, int MaxSpread> class Joint : public pelorus::Extent<Derived>, public Parameters {
public:
    using Shape = InverseWishart<D>;
    static constexpr bool joint = true;
    using Block = pelorus::small::Bounded<max_block, max_block>;
    using State = pelorus::small::Bounded<D, max_block>;  // one column a derivative
    using Spread = pelorus::small::Bounded<MaxSpread, MaxSpread>;

    static void describe(pelorus::Describe<Derived>& plugin) { describe_parameters(plugin); }

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
                item.spread = derived().spread_of(args.covariance, i);
            } else {
                const double dt = args.times.data[args.times.row_stride] - args.times.data[0];
                if (!(dt > 0)) throw pelorus::ArgumentError("times: must ascend");
                const Scatter<D> last = scatter_of<D>(args.scan[1], i);
                item.spread = derived().differenced(item.shape, dt, static_cast<double>(last.points), last.noise);
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
            const Vector<D> before = velocity(item);
            if (dt > 0) {  // dt = 0 must not add the noise of a step
                if (dt != blocks_of) {
                    pelorus::require(structure_->blocks(motion_.self(), &call, dt, transition.data(), noise.data()));
                    blocks_of = dt;
                }
                State moved(D, block_);
                pelorus::small::multiply_transposed(item.state, transition, moved);
                item.state = moved;
                item.spread = derived().moved(item.spread, transition, noise);
            }
            this->template step<D>(item.shape, dt, before, velocity(item));
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
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            Item item = read(args.record, i);
            const Scatter<D> scatter = scatter_of<D>(args.scan, i);
            Told<D> told;
            told.covariance = position_covariance(item);
            if (scatter.points > 0) derived().correct(item, scatter, told);
            write(item, args.out, i);
            if (args.log_likelihood.data != nullptr)
                pelorus::store<1, 1>(args.log_likelihood, i, Matrix<1>::Constant(told.log_likelihood));
            if (args.innovation.data != nullptr) pelorus::store<D, 1>(args.innovation, i, told.innovation);
            if (args.innovation_covariance.data != nullptr)
                pelorus::store<D, D>(args.innovation_covariance, i, told.covariance);
        });
    }

    plr_status joint_summary(const plr_call& call, const plr_joint_summary& args) const {
        const std::int64_t count = args.mean.count;
        const int c = D * block_;
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
            for (int k = 0; k < c; ++k) mean[k] = item.state.data()[k];
            if (args.covariance.data == nullptr) return;
            double* covariance = args.covariance.data + i * args.covariance.item_stride;
            for (int col = 0; col < c; ++col)
                for (int row = 0; row < c; ++row)
                    covariance[col * args.covariance.col_stride + row] = derived().covariance(item, extent, row, col);
        });
    }

    plr_status joint_gate(const plr_call& call, const plr_extent_gate& args) const {
        const std::int64_t count = args.record.count;
        expect_points<D>(args.scan, count);
        pelorus::expect(args.record, this->info.record_size, 1, count, "record");
        pelorus::expect(args.squared_distance, 1, 1, args.scan.offsets[count], "squared_distance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Item item = read(args.record, i);
            const Matrix<D> common = position_covariance(item) + lambda * item.shape.extent();
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

protected:
    struct Item {
        State state;    ///< D x b
        Spread spread;  ///< s x s
        Shape shape;
    };

    /// Takes the motion and the sensors of its slots. Throws PartError where the motion is none that it can take apart.
    void take_parts(const pelorus::Setup& setup) {
        if (innovation_spread) throw pelorus::ParameterError("innovation_spread", "is for update: published only");
        motion_ = setup.part<pelorus::MotionPart>("motion");
        structure_ = motion_.template extension<plr_motion_structure>(PLR_MOTION_STRUCTURE);
        if (structure_ == nullptr)
            throw pelorus::PartError("motion", motion_.id() + " does not offer " PLR_MOTION_STRUCTURE
                                                              ": this update takes a motion F1 (x) I, Q1 (x) I");
        if (structure_->dimension != D)
            throw pelorus::PartError("motion", "has " + std::to_string(structure_->dimension) +
                                                   " axes, the extent has " + std::to_string(D) + " (dimension)");
        if (structure_->block > max_block)
            throw pelorus::PartError("motion", "has " + std::to_string(structure_->block) + " derivatives, at most " +
                                                   std::to_string(max_block) + " are taken");
        block_ = structure_->block;
        for (const auto& sensor : setup.parts<pelorus::SensorPart>("sensors")) {
            sensors_.push_back(sensor.raw());
            sensors_.back().struct_size = sizeof(plr_part);
        }
        space_ = pelorus::Space(*motion_.info().cartesian);
        joint_ = Joint::joint_table(space_.c(), sensors_.data(), static_cast<std::uint32_t>(sensors_.size()));
        this->info.dimension = D;
        this->info.start_scans = start == Start::consistent ? 2 : 1;
        this->info.start_points = random_matrix::start_points<D>(start);
        this->info.record_version = Shape::record_version;
        const int s = derived().spread_size();
        this->info.record_size = D * block_ + s * s + Shape::record_size;
        this->info.scratch_bytes = motion_.info().scratch_bytes;
    }

    int block() const noexcept { return block_; }
    /// The prior variance of derivative k (2: acceleration).
    double prior_variance(int k) const { return space_[k * D].prior_deviation * space_[k * D].prior_deviation; }

    Matrix<D> position_covariance(const Item& item) const {
        const Matrix<D> extent = item.shape.extent();
        Matrix<D> out;
        for (int col = 0; col < D; ++col)
            for (int row = 0; row < D; ++row) out(row, col) = derived().covariance(item, extent, row, col);
        return out;
    }

private:
    const Derived& derived() const noexcept { return static_cast<const Derived&>(*this); }
    Item blank() const {
        const int s = derived().spread_size();
        return {State::Zero(D, block_), Spread::Zero(s, s), Shape{}};
    }
    /// Zero where the motion has none.
    Vector<D> velocity(const Item& item) const {
        return block_ > 1 ? Vector<D>(item.state.col(1)) : Vector<D>(Vector<D>::Zero());
    }
    Item read(const plr_const_view& records, std::int64_t i) const {
        const double* at = records.data + i * records.item_stride;
        Item item = blank();
        for (int k = 0; k < D * block_; ++k) item.state.data()[k] = *at++;
        for (Eigen::Index k = 0; k < item.spread.size(); ++k) item.spread.data()[k] = *at++;
        item.shape = Shape::read(at);
        return item;
    }
    /// Throws NumericError where something is not finite or the shape is not positive definite.
    void write(const Item& item, const plr_view& records, std::int64_t i) const {
        if (!pelorus::small::all_finite(item.state) || !pelorus::small::all_finite(item.spread))
            throw pelorus::NumericError("the kinematics are no longer finite");
        double* at = records.data + i * records.item_stride;
        for (int k = 0; k < D * block_; ++k) *at++ = item.state.data()[k];
        for (Eigen::Index k = 0; k < item.spread.size(); ++k) *at++ = item.spread.data()[k];
        item.shape.write(at);
    }
    void expect_records(const plr_const_view& record, const plr_view& out) const {
        pelorus::expect(record, this->info.record_size, 1, out.count, "record");
        pelorus::expect(out, this->info.record_size, 1, out.count, "out");
    }

    pelorus::MotionPart motion_;
    const plr_motion_structure* structure_ = nullptr;
    int block_ = 0;
    pelorus::Space space_;
    std::vector<plr_part> sensors_;
    plr_extent_joint joint_{};
};

}  // namespace random_matrix
