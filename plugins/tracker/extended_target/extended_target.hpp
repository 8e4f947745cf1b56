/// tracker.extended_target: one extended target, all its measurements of each scan. See README.md.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/innovations.hpp>
#include <pelorus/stage.hpp>

#include "../../common/extended/joint_filter.hpp"
#include "../../common/extended/separate_filter.hpp"
#include "shared_error_filter.hpp"

namespace extended_target {

using namespace extended;

class ExtendedTarget : public pelorus::Stage<ExtendedTarget> {
public:
    static constexpr const char* kind = "tracker";

    static void describe(pelorus::Describe<ExtendedTarget>& plugin) {
        plugin.title("One extended target")
            .purpose(
                "Tracks one target that gives several measurements a scan, position and shape together. All points of "
                "a scan are "
                "taken to be the target's (or those within a gate). It starts by differencing two scans, coasts "
                "through empty ones, "
                "and starts anew when the target is lost.")
            .equation(
                "start: x0 = [c0, (c1 - c0)/T, 0] from the centroids c of two scans; step: predict, centroid with the "
                "extent's "
                "effective noise as one measurement, then the spread of the points");
        plugin.in_port("scans", PLR_MESSAGE_SCAN,
                       "measurements of the sensors in the slot of the estimator or joint extent", PLR_PORT_MANY);
        plugin.in_port("inputs", PLR_MESSAGE_VALUES, "values of the models' inputs", PLR_PORT_OPTIONAL | PLR_PORT_MANY);
        plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "the target, once a scan");
        plugin.out_port("innovations", PLR_MESSAGE_VALUES,
                        "the centroid's normalised innovation squared, for tests of consistency");
        plugin.slot("estimator", "estimator", 0, 1, "the filter of the kinematics; none where the extent owns them");
        plugin.slot("extent", "extent", 1, 1, "the shape");
        plugin.parameter("start_deviations", &ExtendedTarget::start_deviations_)
            .unit("m, m/s, m/s2")
            .initially("[5 m, 1 m/s, 0.5 m/s2]")
            .above(0)
            .doc(
                "deviation of each axis' position, velocity and acceleration at the start, for an extent that starts "
                "from one scan; one "
                "that starts from two implies its own");
        plugin.parameter("misses_to_delete", &ExtendedTarget::misses_to_delete_)
            .initially("5")
            .min(1)
            .doc("empty scans in a row after which the target is given up");
        plugin.parameter("gate", &ExtendedTarget::gate_)
            .above(0)
            .doc("largest statistical distance (deviations) of a point that is used; absent: all points are");
        plugin.parameter("shared_error", &ExtendedTarget::shared_error_)
            .min(0)
            .max(1)
            .rows(1, 8)
            .doc(
                "shares of the sensor's noise that may be one error of all points of a scan, tried side by side and "
                "weighed by their likelihood: [0, 1]; absent: each point has an error of its own");
    }

    void setup(const pelorus::Setup& setup) {
        const auto extent = setup.part<pelorus::ExtentPart>("extent");
        const auto estimator = setup.optional_part<pelorus::EstimatorPart>("estimator");
        const auto* joint = extent.extension<plr_extent_joint>(PLR_EXTENT_JOINT);
        if (joint != nullptr && estimator)
            throw pelorus::PartError("estimator",
                                     "must be empty: the extent (" + extent.id() + ") owns the kinematics, too");
        if (joint == nullptr && !estimator)
            throw pelorus::PartError("estimator",
                                     "is empty: the extent (" + extent.id() + ") has no kinematics of its own");
        if (extent.info().start_scans > 2)
            throw pelorus::PartError("extent", "starts from " + std::to_string(extent.info().start_scans) +
                                                   " scans; this tracker starts from one or two");
        std::uint64_t scratch = extent.info().scratch_bytes;
        if (joint != nullptr) {
            if (shared_error_)
                throw pelorus::ParameterError(
                    "shared_error",
                    "needs an estimator beside the extent; here the extent (" + extent.id() + ") owns the kinematics");
            filter_ = std::make_unique<JointFilter>(extent, *joint);
        } else {
            if (shared_error_)
                filter_ = std::make_unique<SharedErrorFilter>(estimator, extent, *shared_error_);
            else
                filter_ = std::make_unique<SeparateFilter>(estimator, extent);
            scratch = std::max(scratch, estimator.info().scratch_bytes);
        }
        for (const SensorOfPoints& sensor : filter_->sensors())
            scratch = std::max(scratch, sensor.part().info().scratch_bytes);
        caller_.setup(setup, static_cast<std::size_t>(scratch) + 4096);
        random_ = setup.optional_service<plr_random>();
        diagnostics_ = setup.optional_service<plr_diagnostics>();
        log_ = setup.optional_service<plr_log>();
        key_ = setup.key();
        frame_ = setup.frame();
        tracks_ = std::make_unique<pelorus::TracksBuilder>(frame_, filter_->space(), filter_->dimension());
    }

    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const {
        std::vector<pelorus::Stream> streams;
        if (port == 0)
            for (const SensorOfPoints& sensor : filter_->sensors())
                streams.push_back({sensor.part().name(), false, sensor.measurement(), false, frame_, false, false});
        return streams;
    }
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const {
        if (port != 0) return {};
        return {{"", false, filter_->space(), false, frame_, false, false}};
    }

    void on_values(const pelorus::Event&, const plr_values& values) {
        if (caller_.take(values) == 0)
            throw pelorus::DataError("no model of this tracker has an input of any of these names");
    }

    void on_scan(const pelorus::Event& event, const plr_scan& scan) {
        const std::int64_t last = track_ ? track_->time : pending_ ? pending_->time : event.time;
        if (event.time < last)
            throw pelorus::DataError("a scan of sensor " + std::string(scan.sensor) +
                                     " is older than the newest one; sort them first");
        Points points = points_of(event.time, scan);
        ++step_;
        tracks_->clear();
        innovations_.clear();
        if (track_)
            follow(std::move(points));
        else
            begin(std::move(points));
        if (tracks_->count() > 0) publish(0, tracks_->message(event.time));
        if (innovations_.count() > 0) publish(1, innovations_.message(event.time));
    }

    template <class Archive> void state(Archive& archive) {
        std::uint32_t layout = filter_->record_version();
        archive(layout, step_, next_id_, pending_misses_, pending_, track_, caller_);
        if constexpr (Archive::reading) check_state(layout);
    }

private:
    struct Track {
        std::uint64_t id = 0;
        std::int64_t time = 0;  ///< ns
        std::int32_t misses = 0;
        Records records;
        template <class Archive> void state(Archive& archive) { archive(id, time, misses, records); }
    };

    // ------------------------------------------------------------------------------------------------- scans

    Points points_of(std::int64_t time, const plr_scan& scan) {
        std::int64_t refused = 0;
        Points points = filter_->points_of(caller_, time, scan, refused);
        if (refused > 0) count("points_not_converted", refused);
        return points;
    }

    // ------------------------------------------------------------------------------------------------- start

    void begin(Points points) {
        if (points.count() == 0) {
            if (pending_ && ++pending_misses_ >= misses_to_delete_) pending_.reset();
            return;
        }
        const bool two = filter_->extent_info().start_scans == 2;
        const bool enough = points.count() >= filter_->extent_info().start_points;
        if (pending_ && points.time == pending_->time) {
            count("scans_not_used_to_start", 1);  // nothing to be differenced
            return;
        }
        // A second scan that is too small for the start may still end it, where the first one alone makes the shape.
        if (pending_ && (enough || !two)) {
            if (!start(points)) pending_.reset();
            if (track_) {
                pending_.reset();
                return;
            }
        }
        if (!enough) {
            count("scans_not_used_to_start", 1);
            return;
        }
        pending_ = std::move(points);
        pending_misses_ = 0;
    }

    /// Starts a track from the pending scan and this one; false: their points make no shape.
    bool start(const Points& points) {
        const Points first = *pending_;
        const Eigen::VectorXd mean = differenced_mean(first, points);
        const bool two = filter_->extent_info().start_scans == 2;
        Track track;
        track.id = next_id_;
        track.time = two ? points.time : first.time;
        const Look look = look_at(track, track.time);
        try {
            if (two) {
                track.records = filter_->start_differenced(caller_, look, {&first, &points}, mean);
                tell_start(track, first, points);
            } else {
                track.records = filter_->start(caller_, look, {&first}, {mean, start_covariance()});
                tell(track, PLR_TRACK_CONFIRMED, first.ids, filter_->distances(caller_, look, first, track.records));
            }
        } catch (const pelorus::Failure& failure) {
            if (failure.code() != PLR_E_NUMERIC) throw;
            warn("no start: " + std::string(failure.what()));
            count("starts_failed", 1);
            return false;
        }
        ++next_id_;
        track_ = std::move(track);
        if (two) {
            tell(*track_, PLR_TRACK_CONFIRMED, points.ids);
        } else {
            follow(points);
            innovations_.clear();  // this scan made the velocity that it was compared with
        }
        return true;
    }

    /// [centroid, difference quotient, 0]: the position at the time at which the kinematics begin.
    Eigen::VectorXd differenced_mean(const Points& first, const Points& second) const {
        const bool two = filter_->extent_info().start_scans == 2;
        const Eigen::VectorXd before = first.centroid(), after = second.centroid();
        const double dt = static_cast<double>(second.time - first.time) * 1e-9;
        Eigen::VectorXd mean = Eigen::VectorXd::Zero(filter_->space().size());
        for (int c = 0; c < filter_->space().size(); ++c) {
            const int axis = filter_->axis(c);
            if (filter_->derivative(c) == 0) mean(c) = two ? after(axis) : before(axis);
            if (filter_->derivative(c) == 1) mean(c) = (after(axis) - before(axis)) / dt;
        }
        return mean;
    }

    Eigen::MatrixXd start_covariance() const {
        const int c = filter_->space().size();
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(c, c);
        for (int k = 0; k < c; ++k)
            if (filter_->derivative(k) >= 0) out(k, k) = std::pow(start_deviations_(filter_->derivative(k)), 2);
        return out;
    }

    /// What a start from two scans tells of the first: its centroid, with the same velocity and shape. Position and velocity of a
    /// difference are correlated the other way round at its beginning.
    void tell_start(const Track& track, const Points& first, const Points& second) {
        const Look look = look_at(track, second.time);
        Moments moments = filter_->summary(caller_, look, track.records);
        const Eigen::VectorXd centroid = first.centroid();
        const int c = filter_->space().size();
        for (int row = 0; row < c; ++row) {
            if (filter_->derivative(row) == 0) moments.mean(row) = centroid(filter_->axis(row));
            for (int col = 0; col < c; ++col)
                if ((filter_->derivative(row) == 0) != (filter_->derivative(col) == 0))
                    moments.covariance(row, col) *= -1.0;
        }
        add_entry(track, first.time, PLR_TRACK_CONFIRMED, moments, filter_->shape(caller_, look, track.records),
                  first.ids, {});
    }

    // ------------------------------------------------------------------------------------------------- life

    void follow(Points points) {
        Track next = *track_;
        next.time = points.time;
        const Look look = look_at(next, points.time);
        std::vector<double> distances;
        try {
            const std::int64_t elapsed = points.time - track_->time;
            if (elapsed > 0) filter_->predict(caller_, look, static_cast<double>(elapsed) * 1e-9, next.records);
            distances = gate(look, next.records, points);
            if (points.count() > 0) {
                const double squared = filter_->update(caller_, look, points, next.records).squared_innovation;
                innovations_.add(next.id, squared, filter_->dimension());
            }
            next.misses = points.count() > 0 ? 0 : next.misses + 1;
            const bool lost = next.misses >= misses_to_delete_;
            tell(next,
                 lost              ? PLR_TRACK_DELETED
                 : next.misses > 0 ? PLR_TRACK_COASTING
                                   : PLR_TRACK_CONFIRMED,
                 points.ids, distances);
            track_ = std::move(next);
            if (lost) track_.reset();
        } catch (const pelorus::Failure& failure) {
            if (failure.code() != PLR_E_NUMERIC) throw;
            warn("track " + std::to_string(track_->id) + " is given up: " + failure.what());
            count("tracks_failed", 1);
            add_entry(*track_, points.time, PLR_TRACK_DELETED, filter_->summary(caller_, look, track_->records),
                      filter_->shape(caller_, look, track_->records), {}, {});
            track_.reset();
        }
    }

    /// Distances of the points that are kept; with a gate, the others go.
    std::vector<double> gate(const Look& look, const Records& records, Points& points) {
        if (points.count() == 0) return {};
        const std::vector<double> all = filter_->distances(caller_, look, points, records);
        if (!gate_) return all;
        std::vector<bool> inside;
        std::vector<double> kept;
        for (const double distance : all) {
            inside.push_back(distance <= *gate_ * *gate_);
            if (inside.back()) kept.push_back(distance);
        }
        count("points_outside_gate", static_cast<std::int64_t>(all.size() - kept.size()));
        points.keep(inside);
        return kept;
    }

    // ------------------------------------------------------------------------------------------------- telling

    void tell(const Track& track, std::int32_t status, const std::vector<std::uint64_t>& ids,
              const std::vector<double>& distances = {}) {
        const Look look = look_at(track, track.time);
        add_entry(track, track.time, status, filter_->summary(caller_, look, track.records),
                  filter_->shape(caller_, look, track.records), ids, distances);
    }

    void add_entry(const Track& track, std::int64_t time, std::int32_t status, const Moments& moments,
                   const Eigen::MatrixXd& shape, const std::vector<std::uint64_t>& ids,
                   const std::vector<double>& distances) {
        pelorus::TrackEntry entry;
        entry.id = track.id;
        entry.time = time;
        entry.status = status;
        entry.misses = track.misses;
        entry.mean = moments.mean.data();
        entry.covariance = moments.covariance.data();
        entry.extent = shape.data();
        entry.measurements = ids;
        entry.distances = distances;
        tracks_->add(entry);
    }

    Look look_at(const Track& track, std::int64_t time) const {
        Look look{time, track.id, key_};
        if (random_ != nullptr) look.key = random_->derive(key_, PLR_STREAM_PARTICLES, step_, track.id);
        return look;
    }
    void count(const char* name, std::int64_t by) const {
        if (diagnostics_ != nullptr && by > 0) diagnostics_->count(diagnostics_->context, name, by);
    }
    void warn(const std::string& line) const {
        if (log_ != nullptr && PLR_LOG_WARNING >= log_->level)
            log_->write(log_->context, PLR_LOG_WARNING, line.c_str());
    }

    void check_state(std::uint32_t layout) const {
        if (layout != filter_->record_version())
            throw pelorus::Failure(PLR_E_STATE_VERSION, "saved records have version " + std::to_string(layout) +
                                                            ", these models write " +
                                                            std::to_string(filter_->record_version()));
        if (track_ && (track_->records.kinematics.size() != filter_->kinematics_size() ||
                       track_->records.extent.size() != filter_->extent_size()))
            throw pelorus::DataError("saved records are of another size");
        if (pending_ && !pending_->is_of(filter_->dimension(), filter_->sensors().size()))
            throw pelorus::DataError("a saved scan is of another size");
    }

    pelorus::Vector<3> start_deviations_;
    int misses_to_delete_ = 5;
    std::optional<double> gate_;
    std::optional<std::vector<double>> shared_error_;

    std::unique_ptr<TargetFilter> filter_;
    pelorus::Caller caller_;
    std::unique_ptr<pelorus::TracksBuilder> tracks_;
    pelorus::InnovationsBuilder innovations_;
    const plr_random* random_ = nullptr;
    const plr_diagnostics* diagnostics_ = nullptr;
    const plr_log* log_ = nullptr;
    plr_key key_{};
    std::string frame_;

    // What save keeps.
    std::uint64_t step_ = 0, next_id_ = 1;
    std::int32_t pending_misses_ = 0;
    std::optional<Points> pending_;  ///< the first scan of a start
    std::optional<Track> track_;
};

}  // namespace extended_target
