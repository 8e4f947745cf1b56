#include "rigid_registration.hpp"

#include <algorithm>

namespace rigid {

namespace {

/// Those numbers of a list (`width` an item) whose items are good.
template <class T>
std::vector<T> chosen(const T* from, std::int64_t stride, std::size_t width, const std::vector<bool>& is_good) {
    std::vector<T> out;
    for (std::size_t i = 0; i < is_good.size(); ++i) {
        const T* const item = from + static_cast<std::int64_t>(i) * stride;
        if (is_good[i]) out.insert(out.end(), item, item + width);
    }
    return out;
}

/// Where the components of `space` stand in `theirs`. Throws DataError where one is missing.
std::vector<int> places_of(const pelorus::Space& space, const pelorus::Space& theirs) {
    std::vector<int> out;
    for (const pelorus::Component& component : space.components()) {
        out.push_back(theirs.index(component.name));
        if (out.back() < 0) throw pelorus::DataError("tracks without " + component.name + ": " + theirs.text());
    }
    return out;
}

void append_symmetric(const Eigen::MatrixXd& matrix, std::vector<double>& to) {
    const Eigen::MatrixXd symmetric = 0.5 * (matrix + matrix.transpose());
    to.insert(to.end(), symmetric.data(), symmetric.data() + symmetric.size());
}

}  // namespace

void RigidRegistration::describe(pelorus::Describe<RigidRegistration>& plugin) {
    plugin.title("Rigid registration")
        .purpose(
            "Moves scans and tracks into the axes of this node's frame: measurements go through the point that they "
            "are "
            "of, with their covariances, and come out as another sensor would have made them there.")
        .equation(
            "p' = R'(p - L) (forward) or R p + L (inverse), R from a quaternion or an attitude, L a translation or a "
            "site; z' = h'(p'), R_z' = G R_z G', G = H' R' H^-1")
        .source(
            "X. Xiang et al., Computer Measurement & Control 31(5), 2023, section 2 (quaternion registration); Y. "
            "Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley, "
            "2001, section 10.4 (covariances of converted measurements)");
    plugin.slot("moved", "sensor", 0, -1,
                "sensors whose scans are moved, by the names of the scans: like: world.sensors.radar");
    plugin.slot("as", "sensor", 0, 1,
                "what the moved ones are told as: a sensor among the new axes; absent: as positions");
    plugin.slot("local", "sensor", 0, -1,
                "sensors that stand along the new axes already: their scans are told to be in this node's frame and "
                "are left as they are");
    describe_placement(plugin);
    plugin.parameter("direction", &RigidRegistration::direction_)
        .initially("forward")
        .choices({{"forward", "from the surrounding axes into the described ones"},
                  {"inverse", "out of the described axes into the surrounding ones"}})
        .doc("which way things are moved");
    plugin.parameter("covariance", &RigidRegistration::covariance_)
        .initially("transformed")
        .choices({{"transformed", "by the Jacobians of both sensors"},
                  {"kept", "as it was, component by component; `as` must measure what the moved sensor does"}})
        .doc("what becomes of the covariances of moved measurements");
    plugin.parameter("derivatives", &RigidRegistration::derivatives_)
        .initially("velocity")
        .choices({{"position", ""}, {"velocity", ""}, {"acceleration", ""}})
        .doc("up to which derivative tracks are moved; they must tell it, what they tell besides is left out");
    plugin.in_port("scans", PLR_MESSAGE_SCAN, "those of sensors in no slot pass as they are",
                   PLR_PORT_MANY | PLR_PORT_OPTIONAL);
    plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "in space", PLR_PORT_MANY | PLR_PORT_OPTIONAL);
    plugin.in_port("inputs", PLR_MESSAGE_VALUES, "of the sensors in `moved` and `as`, a bias for example",
                   PLR_PORT_MANY | PLR_PORT_OPTIONAL);
    plugin.out_port("scans", PLR_MESSAGE_SCAN, "all scans, moved or passed on");
    plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "the same tracks among the new axes; without records");
}

void RigidRegistration::setup(const pelorus::Setup& setup) {
    frame_ = setup.frame();
    frames_ = setup.optional_service<plr_frames>();
    diagnostics_ = setup.optional_service<plr_diagnostics>();
    if (is_given()) {
        given_ = into();
        if (direction_ == Direction::inverse) given_ = given_.inverse();
    } else if (direction_ == Direction::inverse) {
        throw pelorus::ParameterError("direction",
                                      "says which way a motion goes that is given by parameters; none is, so that "
                                      "scans go from their frame into this node's");
    }
    find_sensors(setup);
}

void RigidRegistration::find_sensors(const pelorus::Setup& setup) {
    const auto as = setup.optional_part<pelorus::SensorPart>("as");
    std::uint64_t scratch = 0;
    for (const auto& sensor : setup.parts<pelorus::SensorPart>("moved")) {
        if (sensor.name().empty()) throw pelorus::PartError("moved", "has a part without a name; scans are told by it");
        const SensorMove move(sensor, as);
        const pelorus::Space measured(*sensor.info().measurement);
        if (covariance_ == Covariance::kept && !measured.same(move.space()))
            throw pelorus::ParameterError("covariance", "cannot be kept: " + sensor.name() + " measures " +
                                                            measured.text() + ", it is told as " + move.space().text());
        if (move.is_of_plane() && is_given()) check_plane(given_, sensor.name());
        scratch = std::max(scratch, move.scratch_bytes());
        moved_.emplace(sensor.name(), move);
        measured_.emplace(sensor.name(), measured);
    }
    for (const auto& sensor : setup.parts<pelorus::SensorPart>("local")) {
        if (sensor.name().empty()) throw pelorus::PartError("local", "has a part without a name; scans are told by it");
        if (moved_.count(sensor.name()) != 0)
            throw pelorus::PartError("local", "has " + sensor.name() + ", which stands in `moved`, too");
        const LocalSensor local(sensor);
        scratch = std::max(scratch, local.scratch_bytes());
        local_.emplace(sensor.name(), local);
    }
    caller_.setup(setup, static_cast<std::size_t>(scratch) + 4096);
}

std::vector<pelorus::Stream> RigidRegistration::in_streams(std::uint32_t port) const {
    std::vector<pelorus::Stream> out;
    pelorus::Stream stream;
    stream.any_frame = true;
    if (port == tracks_in) {
        stream.space = track_space();
        stream.at_least = true;
        return {stream};
    }
    if (port != scans_in) return {};
    const auto add = [&](const std::string& name, const pelorus::Space& space) {
        stream.sensor = name;
        stream.space = space;
        out.push_back(stream);
    };
    for (const auto& [name, space] : measured_) add(name, space);
    for (const auto& [name, sensor] : local_) add(name, sensor.space());
    pelorus::Stream other;
    other.any_sensor = other.any_space = other.any_frame = true;
    out.push_back(other);
    return out;
}

std::vector<pelorus::Stream> RigidRegistration::out_streams(std::uint32_t port) const {
    std::vector<pelorus::Stream> out;
    pelorus::Stream stream;
    stream.frame = frame_;
    if (port == tracks_out) {
        stream.space = track_space();
        return {stream};
    }
    for (const auto& [name, move] : moved_) {
        stream.sensor = name;
        stream.space = move.space();
        out.push_back(stream);
    }
    for (const auto& [name, sensor] : local_) {
        stream.sensor = name;
        stream.space = sensor.space();
        out.push_back(stream);
    }
    return out;
}

pelorus::Space RigidRegistration::track_space() const {
    return pelorus::kinematic_space(3, std::vector<double>(static_cast<std::size_t>(derivatives_) + 1, 0.0));
}

Motion RigidRegistration::motion_from(const char* frame, std::int64_t time) const {
    Motion out;
    if (is_given()) return given_;
    if (frame_ == frame) return out;
    if (frames_ == nullptr) throw pelorus::UnsupportedError("this host has no service " PLR_SERVICE_FRAMES);
    plr_error error{};
    error.struct_size = sizeof error;
    auto pose = pelorus::arguments<plr_frame_pose>();
    const plr_status status = frames_->transform(frames_->context, frame, frame_.c_str(), time, &pose, &error);
    if (status != PLR_OK) throw pelorus::Failure(status, error.message);
    out.rotation = Eigen::Map<const Matrix<3>>(pose.rotation);
    out.translation = Eigen::Map<const Vector<3>>(pose.translation);
    return out;
}

void RigidRegistration::check_local(const plr_scan& scan, std::int64_t time) {
    if (!checked_.insert(scan.sensor).second) return;
    const LocalSensor& sensor = local_.at(scan.sensor);
    if (sensor.stands_there(Motion(), time, caller_) ||
        sensor.stands_there(motion_from(scan.frame, time), time, caller_))
        return;
    throw pelorus::PartError("local", std::string("has ") + scan.sensor +
                                          ", whose position and attitude are not those of " +
                                          (frame_.empty() ? "this node's axes" : "frame " + frame_) +
                                          "; give both the same, or take them out of the sensor");
}

void RigidRegistration::check_plane(const Motion& motion, const std::string& sensor) const {
    if (!motion.keeps_the_plane())
        throw pelorus::DataError("sensor " + sensor + " tells positions in the plane, which this motion tilts");
}

void RigidRegistration::send(std::int64_t time, const plr_scan& scan) {
    plr_message message = pelorus::detail::message_of(PLR_MESSAGE_SCAN, time);
    message.body.scan = &scan;
    publish(scans_out, message);
}

void RigidRegistration::send(std::int64_t time, const plr_tracks& tracks) {
    plr_message message = pelorus::detail::message_of(PLR_MESSAGE_TRACKS, time);
    message.body.tracks = &tracks;
    publish(tracks_out, message);
}

void RigidRegistration::on_scan(const pelorus::Event& event, const plr_scan& scan) {
    plr_scan out = scan;  // the host copies on publishing
    const auto found = moved_.find(scan.sensor);
    if (found == moved_.end()) {
        if (local_.count(scan.sensor) != 0) {
            check_local(scan, event.time);
            out.frame = frame_.c_str();
        }
        return send(event.time, out);
    }
    const SensorMove& move = found->second;
    const pelorus::Space& measured = measured_.at(found->first);
    if (!measured.same(pelorus::Space(*scan.space)))
        throw pelorus::DataError("sensor " + found->first + " measures " + measured.text() + ", its scan has " +
                                 pelorus::Space(*scan.space).text());
    const Motion motion = motion_from(scan.frame, event.time);
    if (move.is_of_plane()) check_plane(motion, found->first);
    const SensorMove::Moved moved = move(scan, event.time, motion, covariance_, caller_);
    const std::vector<bool>& good = moved.is_good;
    const auto count = std::count(good.begin(), good.end(), true);
    if (diagnostics_ != nullptr && count < scan.measurements.count)
        diagnostics_->count(diagnostics_->context, "measurements_not_moved", scan.measurements.count - count);
    const std::int64_t m = move.space().size();
    const auto width = static_cast<std::size_t>(m);
    const auto measurements = chosen(moved.measurements.data(), m, width, good);
    const auto ids = chosen(scan.ids, 1, 1, good);
    std::vector<double> covariances, snr;
    std::vector<std::int64_t> times;
    out.frame = frame_.c_str();
    out.space = move.space().c();
    out.measurements = pelorus::const_view(measurements.data(), m, 1, count);
    out.ids = ids.data();
    if (!moved.covariances.empty()) {
        covariances = chosen(moved.covariances.data(), m * m, width * width, good);
        out.covariances = pelorus::const_view(covariances.data(), m, m, count);
    }
    if (scan.times != nullptr) out.times = (times = chosen(scan.times, 1, 1, good)).data();
    if (scan.snr.data != nullptr) {
        snr = chosen(scan.snr.data, scan.snr.item_stride, 1, good);
        out.snr = pelorus::const_view(snr.data(), 1, 1, count);
    }
    send(event.time, out);
}

void RigidRegistration::on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
    const Motion motion = motion_from(tracks.frame, event.time);
    const pelorus::Space space = track_space(), theirs(*tracks.space);
    const Eigen::Index c = space.size();
    const auto places = places_of(space, theirs);
    std::vector<double> means, covariances, extents;
    for (std::int64_t i = 0; i < tracks.count; ++i) {
        const Eigen::MatrixXd mean = pelorus::item(tracks.mean, i)(places, 0);
        const Eigen::MatrixXd covariance = pelorus::item(tracks.covariance, i)(places, places);
        Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(c, c);
        for (Eigen::Index at = 0; at < c; at += 3) turn.block<3, 3>(at, at) = motion.rotation;
        Eigen::VectorXd moved = turn * mean;
        moved.head<3>() += motion.translation;
        append_symmetric(turn * covariance * turn.transpose(), covariances);
        means.insert(means.end(), moved.data(), moved.data() + c);
        if (tracks.extent.data == nullptr || tracks.extent.rows != 3) continue;
        append_symmetric(motion.rotation * pelorus::item(tracks.extent, i) * motion.rotation.transpose(), extents);
    }
    plr_tracks out = tracks;
    out.frame = frame_.c_str();
    out.space = space.c();
    out.mean = pelorus::const_view(means.data(), c, 1, tracks.count);
    out.covariance = pelorus::const_view(covariances.data(), c, c, tracks.count);
    out.extent = extents.empty() ? pelorus::absent_view() : pelorus::const_view(extents.data(), 3, 3, tracks.count);
    out.records = pelorus::absent_view();
    out.record_of = nullptr;
    send(event.time, out);
}

void RigidRegistration::on_values(const pelorus::Event&, const plr_values& values) { caller_.take(values); }

}  // namespace rigid
