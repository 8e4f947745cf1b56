// How the estimated biases are taken off measurements and tracks.
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "calibration_stage.hpp"

namespace calibration {

namespace {

/// The shortest x with slope x = e, damped where the rows of the slope are not independent.
Eigen::Vector3d shortest(const Eigen::MatrixXd& slope, const Eigen::VectorXd& e) {
    Eigen::MatrixXd square = slope * slope.transpose();
    square.diagonal().array() += 1e-12 * square.trace();
    const Eigen::LLT<Eigen::MatrixXd> factor(square);
    if (factor.info() != Eigen::Success) throw pelorus::NumericError("a line of sight is not finite");
    return slope.transpose() * factor.solve(e);
}

}  // namespace

Estimate CalibrationStage::applied_to(Corrected what) const {
    Estimate out = biases_.estimate();
    BiasVector mask = BiasVector::Zero();  // tracks are moved as a whole; ranges and stamps are the measurements' own
    if (what == Corrected::tracks || corrected_ == Corrected::scans) mask.head<6>().setOnes();
    if (what == Corrected::scans) mask.tail<2>().setOnes();
    out.value = out.value.cwiseProduct(mask);
    out.covariance = mask.asDiagonal() * out.covariance * mask.asDiagonal();
    if (mode_ == Mode::schmidt) {
        out.covariance += out.value * out.value.transpose();
        out.value.setZero();
    } else if (spread_ == Spread::kept) {
        out.covariance.setZero();
    }
    return out;
}

void CalibrationStage::publish_corrected(const pelorus::Event& event, const plr_scan& scan, const Frame& frame) {
    const Estimate estimate = applied_to(Corrected::scans);
    const bool widens = !estimate.covariance.isZero(0);
    if (frame.samples.empty() || last_fixes_.empty() || !pose_ || (estimate.value.isZero(0) && !widens))
        return publish_scan(event.time, scan);
    const std::int64_t n = scan.measurements.count, m = scan.measurements.rows;
    const std::int64_t early = nanoseconds(estimate.value(clock_offset));
    std::vector<double> values, covariances;
    std::vector<std::int64_t> times;
    for (std::int64_t i = 0; i < n; ++i) {
        const Sample& sample = frame.samples[static_cast<std::size_t>(i)];
        Eigen::VectorXd value = sample.value;
        Eigen::MatrixXd noise = sample.variances.asDiagonal();
        if (scan.covariances.data != nullptr) noise = pelorus::item(scan.covariances, i);
        if (!correct(sample, estimate, value, noise)) count("uncorrected");
        values.insert(values.end(), value.data(), value.data() + m);
        covariances.insert(covariances.end(), noise.data(), noise.data() + m * m);
        times.push_back(sample.time - early);
    }
    plr_scan corrected = scan;
    corrected.struct_size = sizeof corrected;
    corrected.measurements = pelorus::const_view(values.data(), m, 1, n);
    if (widens) corrected.covariances = pelorus::const_view(covariances.data(), m, m, n);
    if (scan.times != nullptr) corrected.times = times.data();
    publish_scan(event.time - early, corrected);
}

/// Of the newest fixes the one that lies nearest the line of sight.
Eigen::Vector3d CalibrationStage::place_of(const Sample& sample) {
    const Fix* best = &last_fixes_.front();
    if (last_fixes_.size() == 1) return best->position;
    double least = std::numeric_limits<double>::infinity();
    for (const Fix& fix : last_fixes_) {
        const Eigen::VectorXd expected = sensor_.biased(caller_, fix.position, *pose_, biases_.mean());
        const Eigen::VectorXd e = sensor_.residual(caller_, sample.value, expected);
        const double squared = (e.array().square() / sample.variances.array()).sum();
        if (!(squared < least)) continue;
        least = squared;
        best = &fix;
    }
    return best->position;
}

/// Finds a place where the biased sensor would measure just this, as near as possible to a fix, and asks what it would have
/// measured there without its biases.
bool CalibrationStage::correct(const Sample& sample, const Estimate& estimate, Eigen::VectorXd& value,
                               Eigen::MatrixXd& noise) {
    try {
        Eigen::Vector3d place = place_of(sample);
        const Eigen::VectorXd weights = sample.variances.cwiseSqrt().cwiseInverse();
        for (int pass = 0; pass < 3; ++pass) {
            const Eigen::VectorXd e =
                sensor_.residual(caller_, sample.value, sensor_.biased(caller_, place, *pose_, estimate.value));
            const Eigen::MatrixXd slope =
                weights.asDiagonal() * sensor_.biased_jacobian(caller_, place, *pose_, estimate.value);
            place += shortest(slope, weights.cwiseProduct(e));
        }
        Eigen::VectorXd corrected = sample.value;
        if (!estimate.value.isZero(0)) {
            const Eigen::VectorXd without = sensor_.biased(caller_, place, *pose_, BiasVector::Zero()),
                                  with = sensor_.biased(caller_, place, *pose_, estimate.value);
            corrected += sensor_.residual(caller_, without, with);
            corrected = sensor_.residual(caller_, corrected, Eigen::VectorXd::Zero(corrected.size()));  // wraps angles
        }
        const BiasSlope over = sensor_.bias_slope(caller_, place, *pose_, estimate.value);
        const Eigen::MatrixXd widened = noise + over * estimate.covariance * over.transpose();
        if (!corrected.allFinite() || !widened.allFinite()) return false;
        value = corrected;
        noise = widened;
        return true;
    } catch (const pelorus::Failure& failure) {
        if (failure.code() != PLR_E_NUMERIC) throw;
        return false;
    }
}

void CalibrationStage::on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
    plr_message message = pelorus::detail::message_of(PLR_MESSAGE_TRACKS, event.time);
    message.body.tracks = &tracks;
    const Estimate estimate = applied_to(Corrected::tracks);
    const bool is_right = estimate.value.isZero(0) && estimate.covariance.isZero(0);
    if (corrected_ != Corrected::tracks || !pose_ || is_right || tracks.count == 0) return publish(tracks_out, message);

    const TrackCorrection correction{pelorus::Space(*tracks.space)};
    std::vector<double> means, covariances, extents;
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        Eigen::VectorXd mean = pelorus::item(tracks.mean, i);
        Eigen::MatrixXd covariance = pelorus::item(tracks.covariance, i);
        correction(*pose_, estimate, mean, covariance);
        means.insert(means.end(), mean.data(), mean.data() + mean.size());
        covariances.insert(covariances.end(), covariance.data(), covariance.data() + covariance.size());
        if (tracks.extent.data == nullptr) continue;
        const Eigen::MatrixXd extent = pelorus::item(tracks.extent, i);
        const Eigen::MatrixXd turn =
            TrackCorrection::turn(*pose_, estimate.value).topLeftCorner(extent.rows(), extent.cols());
        const Eigen::MatrixXd turned = turn * extent * turn.transpose();
        extents.insert(extents.end(), turned.data(), turned.data() + turned.size());
    }
    plr_tracks moved = tracks;
    moved.struct_size = sizeof moved;
    moved.mean = pelorus::const_view(means.data(), tracks.mean.rows, 1, tracks.count);
    moved.covariance = pelorus::const_view(covariances.data(), tracks.mean.rows, tracks.mean.rows, tracks.count);
    if (!extents.empty())
        moved.extent = pelorus::const_view(extents.data(), tracks.extent.rows, tracks.extent.cols, tracks.count);
    moved.records = pelorus::absent_view();  // they are of the world as the sensor sees it
    moved.record_of = nullptr;
    message.body.tracks = &moved;
    publish(tracks_out, message);
}

}  // namespace calibration
