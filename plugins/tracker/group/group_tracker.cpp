#include "group_tracker.hpp"

#include <algorithm>
#include <limits>

#include <boost/math/distributions/chi_squared.hpp>

#include "../../common/extended/joint_filter.hpp"
#include "../../common/extended/separate_filter.hpp"

namespace group {

namespace {

double quantile(double probability, int dimension) {
    return boost::math::quantile(boost::math::chi_squared(dimension), probability);
}

}  // namespace

// ------------------------------------------------------------------------------------------------------------- setup

void GroupTracker::setup(const pelorus::Setup& setup) {
    setup_filter(setup);
    const auto partitioner = setup.part<pelorus::PartitionerPart>("partitioner");
    const int dimension = filter_->dimension();
    if (dimension < partitioner.info().dimension_min || dimension > partitioner.info().dimension_max)
        throw pelorus::PartError("partitioner", "splits points of " + std::to_string(partitioner.info().dimension_min) +
                                                    " to " + std::to_string(partitioner.info().dimension_max) +
                                                    " dimensions; the extent has " + std::to_string(dimension));
    setup_threshold(partitioner);
    cells_.setup(partitioner, setup.optional_service<plr_parallel>());
    // Cells that may overlap are made about predictions; elsewhere the tracker itself brings groups to cells, unless told otherwise.
    const bool overlaps = (partitioner.raw().description->flags & PLR_DESCRIPTION_OVERLAP) != 0;
    by_ = association.value_or(overlaps ? Association::by_partitioner : Association::nearest);
    gate_ = quantile(gate_probability, dimension);
    starts_.setup({maximum_speed, quantile(start_gate_probability, dimension)});
    lineage_.setup(gate_);
    random_ = setup.optional_service<plr_random>();
    diagnostics_ = setup.optional_service<plr_diagnostics>();
    log_ = setup.optional_service<plr_log>();
    key_ = setup.key();
    frame_ = setup.frame();
    told_ = std::make_unique<pelorus::TracksBuilder>(frame_, filter_->space(), dimension);
}

void GroupTracker::setup_filter(const pelorus::Setup& setup) {
    const auto extent = setup.part<pelorus::ExtentPart>("extent");
    const auto estimator = setup.optional_part<pelorus::EstimatorPart>("estimator");
    const auto* joint = extent.extension<plr_extent_joint>(PLR_EXTENT_JOINT);
    if (joint != nullptr && estimator)
        throw pelorus::PartError("estimator",
                                 "must be empty: the extent (" + extent.id() + ") owns the kinematics, too");
    if (joint == nullptr && !estimator)
        throw pelorus::PartError("estimator",
                                 "is empty: the extent (" + extent.id() + ") has no kinematics of its own");
    if (extent.info().start_scans > 3)
        throw pelorus::PartError(
            "extent", "starts from " + std::to_string(extent.info().start_scans) + " scans; a group starts from three");
    std::uint64_t scratch = extent.info().scratch_bytes;
    if (joint != nullptr) {
        filter_ = std::make_unique<extended::JointFilter>(extent, *joint);
    } else {
        filter_ = std::make_unique<extended::SeparateFilter>(
            estimator, extent,
            centroid_noise == CentroidNoise::mean ? extended::CentroidNoise::mean : extended::CentroidNoise::effective);
        scratch = std::max(scratch, estimator.info().scratch_bytes);
    }
    for (const extended::SensorOfPoints& sensor : filter_->sensors())
        scratch = std::max(scratch, sensor.part().info().scratch_bytes);
    caller_.setup(setup, static_cast<std::size_t>(scratch) + 4096);
}

void GroupTracker::setup_threshold(const pelorus::PartitionerPart& partitioner) {
    if (!threshold) return;
    pelorus::ValuesBuilder values;
    values.add("partitioner", "threshold", "m", Eigen::MatrixXd::Constant(1, 1, *threshold));
    if (caller_.take(*values.message(0).body.values) == 0)
        throw pelorus::ParameterError(
            "threshold", "the partitioner (" + partitioner.id() + ") has no input `threshold`: leave this out");
}

std::vector<pelorus::Stream> GroupTracker::in_streams(std::uint32_t port) const {
    std::vector<pelorus::Stream> streams;
    if (port == scans)
        for (const extended::SensorOfPoints& sensor : filter_->sensors())
            streams.push_back({sensor.part().name(), false, sensor.measurement(), false, frame_, false, false});
    return streams;
}

std::vector<pelorus::Stream> GroupTracker::out_streams(std::uint32_t port) const {
    if (port != tracks) return {};
    return {{"", false, filter_->space(), false, frame_, false, false}};
}

// ------------------------------------------------------------------------------------------------------------- a scan

void GroupTracker::on_values(const pelorus::Event&, const plr_values& values) {
    if (caller_.take(values) == 0)
        throw pelorus::DataError("no model of this tracker has an input of any of these names");
}

void GroupTracker::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    if (event.time < newest_)
        throw pelorus::DataError("a scan of sensor " + std::string(scan.sensor) +
                                 " is older than the newest one; sort them first");
    const Points points = points_of(event.time, scan);
    ++step_;
    newest_ = event.time;
    told_->clear();
    innovations_.clear();
    predict(event.time);
    update(points);
    end();
    if (told_->count() > 0) publish(tracks, told_->message(event.time));
    if (innovations_.count() > 0) publish(innovations, innovations_.message(event.time));
}

Points GroupTracker::points_of(std::int64_t time, const plr_scan& scan) {
    std::int64_t refused = 0;
    Points points = filter_->points_of(caller_, time, scan, refused);
    count("points_not_converted", refused);
    return points;
}

void GroupTracker::predict(std::int64_t time) {
    for (Track& track : tracks_) {
        track.measurements.clear();
        track.centre = filter_->summary(caller_, look_at(track), track.records).mean.head(filter_->dimension());
        const std::int64_t elapsed = time - track.time;
        if (elapsed == 0) continue;
        Records next = track.records;
        try {
            track.time = time;
            filter_->predict(caller_, look_at(track), static_cast<double>(elapsed) * 1e-9, next);
            track.records = std::move(next);
        } catch (const pelorus::Failure& failure) {
            give_up(track, failure);
        }
    }
}

Predictions GroupTracker::predictions() const {
    Predictions out;
    const int d = filter_->dimension();
    for (const Track& track : tracks_) {
        const Moments moments = filter_->summary(caller_, look_at(track), track.records);
        out.add(track.id, moments.mean.head(d), moments.covariance.topLeftCorner(d, d),
                filter_->shape(caller_, look_at(track), track.records));
    }
    return out;
}

void GroupTracker::update(const Points& points) {
    const Predictions expected = predictions();
    plr_key key = key_;
    if (random_ != nullptr) key = random_->derive(key_, PLR_STREAM_PARTICLES, step_, 0);
    const std::vector<Cell> cells =
        cells_.split(caller_, caller_.begin(points.time, 1, &step_, &key), points, expected);
    Sighting sighting{points, std::vector<std::vector<std::uint64_t>>(points.ids.size())};
    const auto cell_of = cells_of_tracks(points, expected, cells);
    std::vector<bool> is_taken(cells.size(), false);
    std::vector<bool> is_hit(tracks_.size(), false);
    for (std::size_t k = 0; k < tracks_.size(); ++k) {
        if (!cell_of[k] || tracks_[k].is_lost) continue;
        is_taken[*cell_of[k]] = true;
        is_hit[k] = true;
        take(tracks_[k], points, cells[*cell_of[k]], sighting);
    }
    for (std::size_t k = 0; k < tracks_.size(); ++k)
        if (!is_hit[k] && !tracks_[k].is_lost) miss(tracks_[k], sighting);
    merge_duplicates();
    begin(points, cells, is_taken, sighting);
    lineage_.see(std::move(sighting));
}

void GroupTracker::take(Track& track, const Points& points, const Cell& cell, Sighting& sighting) {
    Records next = track.records;
    try {
        const Points members =
            points.some(cell.members, by_ == Association::by_partitioner ? cell.weights : std::vector<double>());
        const extended::Update result = filter_->update(caller_, look_at(track), members, next);
        innovations_.add(track.id, result.squared_innovation, filter_->dimension());
        track.records = std::move(next);
        track.misses = 0;
        track.absorber = 0;
        track.measurements = members.ids;
        for (const std::size_t member : cell.members) sighting.owners[member].push_back(track.id);
    } catch (const pelorus::Failure& failure) {
        give_up(track, failure);
    }
}

/// The prediction stands. Who has taken the nearest of what could be the group's is noted: if the group stays away, it went there.
void GroupTracker::miss(Track& track, const Sighting& sighting) {
    ++track.misses;
    track.is_lost = track.misses >= misses_to_delete;
    try {
        std::vector<double> distances;
        if (sighting.points.count() > 0)
            distances = filter_->distances(caller_, look_at(track), sighting.points, track.records);
        if (const std::uint64_t owner = owner_of_nearest(sighting, distances, gate_)) track.absorber = owner;
    } catch (const pelorus::Failure& failure) {
        give_up(track, failure);
    }
    if (track.is_lost) absorb(track.absorber, track.id);
}

/// Of two groups at one place the younger one ends: they live on the same measurements.
void GroupTracker::merge_duplicates() {
    if (!(duplicate_distance > 0)) return;
    const int d = filter_->dimension();
    std::vector<Eigen::VectorXd> places;
    for (const Track& track : tracks_)
        places.push_back(filter_->summary(caller_, look_at(track), track.records).mean.head(d));
    for (std::size_t younger = 1; younger < tracks_.size(); ++younger)
        for (std::size_t elder = 0; elder < younger && !tracks_[younger].is_lost; ++elder) {
            if (tracks_[elder].is_lost || !((places[younger] - places[elder]).norm() < duplicate_distance)) continue;
            tracks_[younger].is_lost = true;
            absorb(tracks_[elder].id, tracks_[younger].id);
            count("duplicates_removed", 1);
        }
}

// ------------------------------------------------------------------------------------------------------------- starts

void GroupTracker::begin(const Points& points, const std::vector<Cell>& cells, const std::vector<bool>& is_taken,
                         Sighting& sighting) {
    if (points.time <= starts_.newest_time()) {
        count("scans_not_used_to_start", 1);  // nothing to be differenced
        return;
    }
    Centres left{points.time, {}};
    for (std::size_t c = 0; c < cells.size(); ++c)
        if (!is_taken[c]) left.centres.push_back(centre_of(points.some(cells[c].members), c));
    for (const Start& start : starts_.take(std::move(left))) begin_one(start, cells, sighting);
}

void GroupTracker::begin_one(const Start& start, const std::vector<Cell>& cells, Sighting& sighting) {
    Track track;
    track.id = next_id_;
    track.time = start.third.points.time;
    try {
        track.records = start_records(look_at(track), start);
    } catch (const pelorus::Failure& failure) {
        if (failure.code() != PLR_E_NUMERIC) throw;
        warn("no start: " + std::string(failure.what()));
        count("starts_failed", 1);
        return;
    }
    ++next_id_;
    track.parents = lineage_.parents_of(start);
    track.measurements = start.third.points.ids;
    for (const std::size_t member : cells[static_cast<std::size_t>(start.third.cell)].members)
        sighting.owners[member].push_back(track.id);
    tracks_.push_back(std::move(track));
    count("tracks_started", 1);
}

Records GroupTracker::start_records(const Look& look, const Start& start) const {
    const std::vector<const Points*> all{&start.first.points, &start.second.points, &start.third.points};
    const std::vector<const Points*> shaping(all.end() - filter_->extent_info().start_scans, all.end());
    Moments moments = start_moments(start);
    // The mean velocity belongs to the middle of the time. The motion itself tells what became of it until the end.
    Records carried = filter_->start(caller_, look, shaping, moments);
    filter_->predict(caller_, look, start.half_time, carried);
    const Moments later = filter_->summary(caller_, look, carried);
    for (int c = 0; c < filter_->space().size(); ++c)
        if (filter_->derivative(c) == 1) moments.mean(c) = later.mean(c);
    return filter_->start(caller_, look, shaping, moments);
}

/// [z3; (z3 - z1)/T13; 0], P_pp = R3, P_pv = R3/T13, P_vv = (R1 + R3)/T13^2, P_aa = `start_acceleration`^2 I.
Moments GroupTracker::start_moments(const Start& start) const {
    const int size = filter_->space().size();
    const double whole = 2 * start.half_time;
    Moments out{Eigen::VectorXd::Zero(size), Eigen::MatrixXd::Zero(size, size)};
    for (int col = 0; col < size; ++col) {
        const int derivative = filter_->derivative(col);
        if (derivative < 0) continue;
        const int axis = filter_->axis(col);
        if (derivative == 0) out.mean(col) = start.third.position(axis);
        if (derivative == 1) out.mean(col) = start.velocity(axis);
        if (derivative == 2) out.covariance(col, col) = start_acceleration * start_acceleration;
        for (int row = 0; row < size; ++row) {
            const int other = filter_->derivative(row), along = filter_->axis(row);
            if (derivative > 1 || other < 0 || other > 1) continue;
            const double third = start.third.noise(along, axis), first = start.first.noise(along, axis);
            const int order = derivative + other;
            out.covariance(row, col) = order == 0   ? third
                                       : order == 1 ? third / whole
                                                    : (first + third) / (whole * whole);
        }
    }
    return out;
}

// ------------------------------------------------------------------------------------------------------------- ends, telling

void GroupTracker::end() {
    for (const Track& track : tracks_)
        tell(track, track.is_lost ? PLR_TRACK_DELETED : track.misses > 0 ? PLR_TRACK_COASTING : PLR_TRACK_CONFIRMED);
    tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(), [](const Track& track) { return track.is_lost; }),
                  tracks_.end());
}

void GroupTracker::give_up(Track& track, const pelorus::Failure& failure) {
    if (failure.code() != PLR_E_NUMERIC) throw;
    warn("group " + std::to_string(track.id) + " is given up: " + failure.what());
    count("tracks_failed", 1);
    track.is_lost = true;
}

void GroupTracker::absorb(std::uint64_t survivor, std::uint64_t absorbed) {
    const auto found = std::find_if(tracks_.begin(), tracks_.end(),
                                    [&](const Track& track) { return track.id == survivor && !track.is_lost; });
    if (found == tracks_.end()) return;
    const auto place = std::lower_bound(found->parents.begin(), found->parents.end(), absorbed);
    if (place == found->parents.end() || *place != absorbed) found->parents.insert(place, absorbed);
    count("groups_merged", 1);
}

void GroupTracker::tell(const Track& track, std::int32_t status) {
    const Moments moments = filter_->summary(caller_, look_at(track), track.records);
    const Eigen::MatrixXd shape = filter_->shape(caller_, look_at(track), track.records);
    pelorus::TrackEntry entry;
    entry.id = track.id;
    entry.time = track.time;
    entry.status = status;
    entry.misses = track.misses;
    entry.mean = moments.mean.data();
    entry.covariance = moments.covariance.data();
    entry.extent = shape.data();
    entry.parents = track.parents;
    entry.measurements = track.measurements;
    told_->add(entry);
}

Look GroupTracker::look_at(const Track& track) const {
    Look look{track.time, track.id, key_};
    if (random_ != nullptr) look.key = random_->derive(key_, PLR_STREAM_PARTICLES, step_, track.id);
    return look;
}

void GroupTracker::count(const char* name, std::int64_t by) const {
    if (diagnostics_ != nullptr && by > 0) diagnostics_->count(diagnostics_->context, name, by);
}

void GroupTracker::warn(const std::string& line) const {
    if (log_ != nullptr && PLR_LOG_WARNING >= log_->level) log_->write(log_->context, PLR_LOG_WARNING, line.c_str());
}

void GroupTracker::check_state(std::uint32_t layout) const {
    if (layout != filter_->record_version())
        throw pelorus::Failure(PLR_E_STATE_VERSION, "saved records have version " + std::to_string(layout) +
                                                        ", these models write " +
                                                        std::to_string(filter_->record_version()));
    for (const Track& track : tracks_)
        if (track.records.kinematics.size() != filter_->kinematics_size() ||
            track.records.extent.size() != filter_->extent_size())
            throw pelorus::DataError("saved records are of another size");
    const std::size_t sensors = filter_->sensors().size();
    if (!starts_.is_of(filter_->dimension(), sensors) || !lineage_.is_of(filter_->dimension(), sensors))
        throw pelorus::DataError("a saved scan is of another size");
}

}  // namespace group
