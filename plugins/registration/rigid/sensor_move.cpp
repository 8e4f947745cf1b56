#include "sensor_move.hpp"

#include <Eigen/LU>
#include <pelorus/small_matrix.hpp>

namespace rigid {

using pelorus::SensorPart;

namespace {

/// Axes that a sensor looks along, if it looks at a position and at nothing else; else 0.
std::int64_t axes_of(const SensorPart& sensor) {
    const pelorus::Space seen(*sensor.info().cartesian);
    for (const int axes : {2, 3})
        if (seen.same(pelorus::position_space(axes))) return axes;
    return 0;
}

/// The leading d x d block of item i, the rest that of the identity.
Matrix<3> embedded(const std::vector<double>& blocks, std::size_t i, std::int64_t d) {
    Matrix<3> out = Matrix<3>::Identity();
    const double* const block = blocks.data() + i * static_cast<std::size_t>(d * d);
    for (std::int64_t c = 0; c < d; ++c)
        for (std::int64_t r = 0; r < d; ++r) out(r, c) = block[c * d + r];
    return out;
}

std::vector<double> packed(const plr_const_view& from) {
    std::vector<double> out;
    out.reserve(static_cast<std::size_t>(from.rows * from.cols * from.count));
    for (std::int64_t i = 0; i < from.count; ++i)
        for (std::int64_t c = 0; c < from.cols; ++c)
            for (std::int64_t r = 0; r < from.rows; ++r)
                out.push_back(from.data[i * from.item_stride + c * from.col_stride + r * from.row_stride]);
    return out;
}

}  // namespace

/// The scan at hand: d numbers a point and a measurement.
struct SensorMove::Batch {
    std::int64_t time, count, d;
    std::vector<double> measurements, points, moved;
    Moved out;

    plr_const_view in(const std::vector<double>& numbers, std::int64_t columns = 1) const {
        return pelorus::const_view(numbers.data(), d, columns, count);
    }
    plr_view to(std::vector<double>& numbers, std::int64_t columns = 1) const {
        numbers.resize(static_cast<std::size_t>(d * columns * count));
        return pelorus::view(numbers.data(), d, columns, count);
    }
    /// Takes over which items a call has failed.
    void judge(const pelorus::Caller& caller) {
        for (std::size_t i = 0; i < out.is_good.size(); ++i)
            if (caller.item_failed(i)) out.is_good[i] = false;
    }
};

SensorMove::SensorMove(const SensorPart& from, const SensorPart& into) : from_(from), into_(into) {
    const plr_sensor_info& info = from.info();
    dimension_ = axes_of(from);
    if (dimension_ == 0 || (info.flags & PLR_SENSOR_CAN_INVERT) == 0 || info.inverse->size != info.cartesian->size ||
        info.measurement->size != info.cartesian->size)
        throw pelorus::PartError("moved", from.name() + " measures " + pelorus::Space(*info.measurement).text() +
                                              "; only a measurement that determines a position, and tells nothing "
                                              "besides, can be moved");
    space_ = into ? pelorus::Space(*into.info().measurement) : pelorus::position_space(static_cast<int>(dimension_));
    if (into && (axes_of(into) != dimension_ || space_.size() != dimension_))
        throw pelorus::PartError("as", "measures " + space_.text() + " of " +
                                           pelorus::Space(*into.info().cartesian).text() + ", sensor " + from.name() +
                                           " tells " + std::to_string(dimension_) + " coordinates of a position");
}

std::uint64_t SensorMove::scratch_bytes() const {
    return std::max(from_.info().scratch_bytes, into_ ? into_.info().scratch_bytes : 0);
}

SensorMove::Moved SensorMove::operator()(const plr_scan& scan, std::int64_t time, const Motion& motion,
                                         Covariance covariance, pelorus::Caller& caller) const {
    Batch batch{time, scan.measurements.count, dimension_, packed(scan.measurements), {}, {}, {}};
    batch.out.is_good.assign(static_cast<std::size_t>(batch.count), true);
    if (batch.count == 0) return batch.out;
    find_points(batch, caller);
    for (std::int64_t i = 0; i < batch.count; ++i) {
        Vector<3> point = Vector<3>::Zero();
        std::copy_n(batch.points.begin() + i * dimension_, dimension_, point.data());
        const Vector<3> there = motion(point);
        batch.moved.insert(batch.moved.end(), there.data(), there.data() + dimension_);
    }
    batch.out.measurements = batch.moved;
    if (into_) {
        auto args = pelorus::arguments<plr_sensor_measure>();
        args.cartesian = batch.in(batch.moved);
        args.out = batch.to(batch.out.measurements);
        caller.tolerate(into_.call(&plr_sensor::measure, caller.begin(time, batch.count), args), "as, measure");
        batch.judge(caller);
    }
    find_noise(batch, scan, covariance, caller);
    if (covariance == Covariance::transformed) transform_noise(batch, motion, caller);
    return std::move(batch.out);
}

/// The points that the measurements are of: without noise, an inversion is no more than that.
void SensorMove::find_points(Batch& batch, pelorus::Caller& caller) const {
    const std::vector<double> none(static_cast<std::size_t>(dimension_ * dimension_), 0.0);
    auto args = pelorus::arguments<plr_sensor_invert>();
    args.measurement = batch.in(batch.measurements);
    args.noise = pelorus::common_view(none.data(), dimension_, dimension_, batch.count);
    args.mean = batch.to(batch.points);
    args.covariance = pelorus::absent_output();
    caller.tolerate(from_.call(&plr_sensor::invert, caller.begin(batch.time, batch.count), args),
                    "moved." + from_.name() + ", invert");
    batch.judge(caller);
}

/// The scan's covariances, or the sensor's own noise where it has none and it is wanted.
void SensorMove::find_noise(Batch& batch, const plr_scan& scan, Covariance covariance, pelorus::Caller& caller) const {
    if (scan.covariances.data != nullptr) {
        plr_const_view all = scan.covariances;
        all.count = batch.count;  // one may be common to all
        batch.out.covariances = packed(all);
        return;
    }
    if (covariance == Covariance::kept) return;
    auto args = pelorus::arguments<plr_sensor_noise>();
    args.cartesian = batch.in(batch.points);
    args.snr = scan.snr;
    args.waveform = scan.waveform;
    if (args.waveform.data != nullptr) {
        args.waveform.count = batch.count;
        args.waveform.item_stride = 0;
    }
    args.out = batch.to(batch.out.covariances, dimension_);
    caller.tolerate(from_.call(&plr_sensor::noise, caller.begin(batch.time, batch.count), args),
                    "moved." + from_.name() + ", noise");
    batch.judge(caller);
}

std::vector<double> SensorMove::slopes(const SensorPart& sensor, const std::vector<double>& points, Batch& batch,
                                       pelorus::Caller& caller) const {
    std::vector<double> out;
    auto args = pelorus::arguments<plr_sensor_jacobian>();
    args.cartesian = batch.in(points);
    args.out = batch.to(out, dimension_);
    caller.tolerate(sensor.call(&plr_sensor::jacobian, caller.begin(batch.time, batch.count), args),
                    "sensor " + sensor.name() + ", jacobian");
    batch.judge(caller);
    return out;
}

void SensorMove::transform_noise(Batch& batch, const Motion& motion, pelorus::Caller& caller) const {
    const std::vector<double> before = slopes(from_, batch.points, batch, caller);
    const std::vector<double> after = into_ ? slopes(into_, batch.moved, batch, caller) : std::vector<double>();
    for (std::size_t i = 0; i < batch.out.is_good.size(); ++i) {
        if (!batch.out.is_good[i]) continue;
        Matrix<3> slope;
        pelorus::small::multiply(motion.rotation, Matrix<3>(embedded(before, i, dimension_).inverse()), slope);
        if (into_) slope = (embedded(after, i, dimension_) * slope).eval();
        const Matrix<3> noise = embedded(batch.out.covariances, i, dimension_);
        Matrix<3> seen;
        pelorus::small::symmetric_product(slope, noise, seen);
        batch.out.is_good[i] = seen.allFinite();
        double* const to = batch.out.covariances.data() + i * static_cast<std::size_t>(dimension_ * dimension_);
        for (std::int64_t c = 0; c < dimension_; ++c)
            for (std::int64_t r = 0; r < dimension_; ++r) to[c * dimension_ + r] = seen(r, c);
    }
}

}  // namespace rigid
