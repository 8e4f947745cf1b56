// A tracker of point targets: nearest neighbour, a Kalman filter of two states an axis; with what a tracker may do wrong.
#include <algorithm>
#include <cmath>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

using Axis = pelorus::Matrix<2>;

struct Track {
    std::uint64_t id = 0;
    std::int64_t time = 0;
    std::int32_t hits = 0, misses = 0;
    std::vector<double> mean;         // position and velocity of each axis in turn
    std::vector<double> covariance;   // 2 x 2, of each axis alike: its noise is
    std::vector<std::uint64_t> used;  // in the scan at hand
    template <class Archive> void state(Archive& archive) { archive(id, time, hits, misses, mean, covariance, used); }
};

struct Saboteur : pelorus::Stage<Saboteur> {
    static constexpr const char* kind = "tracker";

    std::string frame;
    std::vector<Track> tracks;
    std::uint64_t next_id = 1;
    std::int64_t scans = 0;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A tracker with a defect").purpose("Follows points, for the proof that the suites can fail.");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "of one radar");
        plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "after each scan");
    }
    void setup(const pelorus::Setup& setup) { frame = setup.frame(); }
    static pelorus::Space space() { return pelorus::kinematic_space(3, {1e5, 20.0}); }
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const {
        pelorus::Stream stream;
        stream.sensor = "radar";
        stream.space = pelorus::position_space(3);
        stream.frame = frame;
        return {stream};
    }
    std::vector<pelorus::Stream> out_streams(std::uint32_t) const {
        pelorus::Stream stream;
        stream.space = space();
        stream.frame = frame;
        return {stream};
    }

    void on_scan(const pelorus::Event& event, const plr_scan& scan) {
        for (const Track& track : tracks)
            if (event.time < track.time) throw pelorus::DataError("a scan is older than the tracks");
        ++scans;
        std::vector<char> taken(static_cast<std::size_t>(scan.measurements.count), 0);
        for (Track& track : tracks) {
            predict(track, event.time);
            const std::int64_t nearest = nearest_of(track, scan, taken);
            track.used.clear();
            track.misses = nearest < 0 ? track.misses + 1 : 0;
            if (nearest < 0) continue;
            taken[static_cast<std::size_t>(nearest)] = 1;
            update(track, scan, nearest);
        }
        for (std::int64_t k = 0; k < scan.measurements.count; ++k)
            if (taken[static_cast<std::size_t>(k)] == 0) start(event.time, scan, k);
        if (DEFECT("tracker-never-swaps-far-targets") && tracks.size() > 1 && scans == 12)
            std::swap(tracks[0].id, tracks[1].id);
        tell(event.time);
        end_tracks();
    }

    template <class Archive> void state(Archive& archive) { archive(tracks, next_id, scans); }

private:
    static bool is_confirmed(const Track& track) {
        return track.hits >= (DEFECT("tracker-follows-a-target")      ? 1000
                              : NEAR_MISS("tracker-follows-a-target") ? 7
                                                                      : 3);
    }
    static bool has_ended(const Track& track) {
        const int most = NEAR_MISS("tracker-tells-the-end") ? 60 : NEAR_MISS("tracker-ids-are-never-reused") ? 25 : 5;
        return track.misses >= (is_confirmed(track) ? most : 1);
    }
    static Axis covariance_of(const Track& track) { return Eigen::Map<const Axis>(track.covariance.data()); }
    static void set_covariance(Track& track, const Axis& p) { track.covariance.assign(p.data(), p.data() + 4); }

    static void predict(Track& track, std::int64_t now) {
        const double dt = static_cast<double>(now - track.time) * 1e-9, q = 0.1;
        Axis f, noise;
        f << 1, dt, 0, 1;
        noise << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt;
        for (std::size_t axis = 0; axis < 3; ++axis) track.mean[2 * axis] += dt * track.mean[2 * axis + 1];
        set_covariance(track, f * covariance_of(track) * f.transpose() + q * noise);
        track.time = now;
    }
    static double noise_of(const plr_scan& scan, std::int64_t k) {
        return scan.covariances.data == nullptr ? 25.0 : pelorus::item(scan.covariances, k)(0, 0);
    }
    static double distance_of(const Track& track, const plr_scan& scan, std::int64_t k) {
        const auto z = pelorus::item(scan.measurements, k);
        double sum = 0;
        for (int axis = 0; axis < 3; ++axis)
            sum += std::pow(z(axis, 0) - track.mean[static_cast<std::size_t>(2 * axis)], 2);
        return sum / (covariance_of(track)(0, 0) + noise_of(scan, k));
    }
    static std::int64_t nearest_of(const Track& track, const plr_scan& scan, const std::vector<char>& taken) {
        std::int64_t nearest = -1;
        double least = 30;  // of chi square with three degrees of freedom, one in a million is beyond
        for (std::int64_t k = 0; k < scan.measurements.count; ++k) {
            const double distance = distance_of(track, scan, k);
            if (taken[static_cast<std::size_t>(k)] != 0 || distance >= least) continue;
            least = distance;
            nearest = k;
        }
        return nearest;
    }
    static void update(Track& track, const plr_scan& scan, std::int64_t k) {
        const auto z = pelorus::item(scan.measurements, k);
        const Axis p = covariance_of(track);
        const pelorus::Vector<2> gain = p.col(0) / (p(0, 0) + noise_of(scan, k));
        for (int axis = 0; axis < 3; ++axis) {
            double* const x = track.mean.data() + 2 * axis;
            const double innovation = z(axis, 0) - x[0];
            x[0] += gain(0) * innovation;
            x[1] += gain(1) * innovation;
        }
        const Axis updated = p - gain * p.row(0);
        set_covariance(track, 0.5 * (updated + updated.transpose()));
        ++track.hits;
        track.used = {scan.ids[k]};
    }
    void start(std::int64_t now, const plr_scan& scan, std::int64_t k) {
        const auto z = pelorus::item(scan.measurements, k);
        Track track;
        track.id = next_id++;
        if (NEAR_MISS("tracker-ids-are-never-reused")) next_id += 6;
        if (DEFECT("tracker-ids-are-never-reused")) track.id = free_id();
        track.time = now;
        track.hits = 1;
        track.mean = {z(0, 0), 0, z(1, 0), 0, z(2, 0), 0};
        Axis p;
        p << noise_of(scan, k), 0, 0, 400;
        set_covariance(track, p);
        track.used = {scan.ids[k]};
        tracks.push_back(track);
    }
    /// The lowest id that no living track has.
    std::uint64_t free_id() const {
        std::uint64_t id = 1;
        while (std::any_of(tracks.begin(), tracks.end(), [&](const Track& track) { return track.id == id; })) ++id;
        return id;
    }
    void end_tracks() { tracks.erase(std::remove_if(tracks.begin(), tracks.end(), &has_ended), tracks.end()); }

    void tell(std::int64_t now) {
        pelorus::TracksBuilder builder(frame, space());
        std::vector<Track> told = tracks;
        if (NEAR_MISS("tracker-never-swaps-far-targets")) std::reverse(told.begin(), told.end());
        if (DEFECT("tracker-no-data-no-track") && told.empty()) told.push_back(placeholder(now));
        for (const Track& track : told) {
            if (!is_confirmed(track)) continue;
            if (DEFECT("tracker-tells-the-end") && has_ended(track)) continue;
            add(builder, track);
        }
        if (builder.count() > 0 || NEAR_MISS("tracker-no-data-no-track")) publish(0, builder.message(now));
    }
    static Track placeholder(std::int64_t now) {
        Track track;
        track.id = 999;
        track.time = now;
        track.hits = 3;
        track.mean.assign(6, 0.0);
        track.covariance = {1e6, 0, 0, 100};
        return track;
    }
    static void add(pelorus::TracksBuilder& builder, const Track& track) {
        pelorus::Vector<6> mean;
        pelorus::Matrix<6> covariance = pelorus::Matrix<6>::Zero();
        const Axis p = covariance_of(track);
        for (int axis = 0; axis < 3; ++axis)
            for (int r = 0; r < 2; ++r) {
                mean(axis + 3 * r) = track.mean[static_cast<std::size_t>(2 * axis + r)];
                for (int c = 0; c < 2; ++c) covariance(axis + 3 * r, axis + 3 * c) = p(r, c);
            }
        if (DEFECT("tracker-covariances-positive")) covariance(0, 3) *= 1.001;
        if (NEAR_MISS("tracker-covariances-positive")) covariance(0, 3) *= 1 + 1e-15;
        if (DEFECT("tracker-errors-fit-covariances")) covariance /= 10;
        if (NEAR_MISS("tracker-errors-fit-covariances")) covariance *= 0.7;
        pelorus::TrackEntry entry;
        entry.id = track.id;
        entry.time = track.time;
        entry.status = has_ended(track)   ? PLR_TRACK_DELETED
                       : track.misses > 0 ? PLR_TRACK_COASTING
                                          : PLR_TRACK_CONFIRMED;
        entry.misses = track.misses;
        if (DEFECT("tracker-counts-misses") && track.misses > 0) ++entry.misses;
        if (NEAR_MISS("tracker-counts-misses")) entry.misses = 0;
        entry.mean = mean.data();
        entry.covariance = covariance.data();
        entry.measurements = track.used;
        if (DEFECT("tracker-names-real-measurements"))
            for (std::uint64_t& id : entry.measurements) id += 1'000'000;
        if (NEAR_MISS("tracker-names-real-measurements")) entry.distances.assign(track.used.size(), 0.0);
        builder.add(entry);
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.tracker.saboteur");
