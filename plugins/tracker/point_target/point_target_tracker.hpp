/// tracker.point_target: many point targets by gating and global nearest neighbour or joint probabilities. See README.md.
#pragma once

#include <optional>
#include <set>

#include <pelorus/innovations.hpp>
#include <pelorus/stage.hpp>

#include "gating.hpp"
#include "joint_update.hpp"

namespace point_target {

enum class Association { nearest, joint };
enum class Start { one_point, two_point, three_point };
enum class Misses { per_scan, by_time };
enum class Publish { updated, all };
enum class Tentative { hide, show };

struct Parameters {
    double gate_probability = 0, maximum_speed = 0;  // -, m/s
    Association association = Association::nearest;
    double detection_probability = 0;
    std::optional<double> clutter_density;  // 1 / unit of the measurement space, SI
    int most_joint_events = 0;
    Start start = Start::one_point;
    int start_confirm = 3, start_of = 5, misses_to_delete = 5;
    Misses misses = Misses::per_scan;
    std::optional<double> silence, maximum_deviation;  // s, m
    Publish publish_which = Publish::updated;
    Tentative tentative = Tentative::hide;
};

class PointTargetTracker : public pelorus::Stage<PointTargetTracker>, public Parameters {
public:
    static constexpr const char* kind = "tracker";
    enum InPort : std::uint32_t { scans, inputs };
    enum OutPort : std::uint32_t { tracks_out, innovations_out, smoothed_out };

    static void describe(pelorus::Describe<PointTargetTracker>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const;

    void on_scan(const pelorus::Event& event, const plr_scan& scan);
    void finish(const pelorus::Event& event);
    void on_values(const pelorus::Event& event, const plr_values& values);

    static constexpr std::uint32_t state_version = 3;
    template <class Archive> void state(Archive& archive) {
        std::uint64_t record_size = models_.record_size();
        std::uint32_t record_version = models_.record_version();
        archive(record_size, record_version);
        if (record_size != models_.record_size() || record_version != models_.record_version())
            throw pelorus::Failure(PLR_E_STATE_VERSION, "saved tracks have records of another estimator (version " +
                                                            std::to_string(record_version) + ", this one has " +
                                                            std::to_string(models_.record_version()) + ")");
        archive(tracks_, next_id_, step_, confirmed_, newest_, next_sweep_, models_.caller());
    }

private:
    static constexpr std::size_t none = Gating::none;
    /// What happens to a track in a scan.
    struct Outcome {
        std::size_t detection = none;   ///< taken
        std::size_t prediction = none;  ///< that it was taken from
        double distance = 0;
        bool changed = false;  ///< of another status than before
        bool removed = false;
        std::size_t mixture = none;  ///< index into the tracks of the joint update, whose record the track has
        bool moved = false;          ///< to another time than before
        bool hit() const noexcept { return detection != none; }
    };
    /// A track of which mean and covariance are wanted, and where they come from.
    struct Wanted {
        std::size_t track;
        std::int64_t time;
    };

    // A scan, step by step.
    bool predicts_all();
    std::vector<GatedPair> free_pairs(bool confirmed) const;
    void associate_tracks(bool confirmed);
    void associate_jointly();
    std::int64_t record_time(const Outcome& outcome) const;
    void associate_points();
    bool is_hypothesis(const Track& track) const;
    void choose_hypotheses();
    void drop_rivals(const std::set<std::uint64_t>& used);
    void branch_points();
    std::vector<GatedPair> free_point_pairs() const;
    void update_tracks();
    void bring_forward(const std::vector<std::size_t>& tracks, std::vector<double>& records, Failures& failed);
    void start_tracks();
    void add_track(std::size_t detection, const double* record);
    void settle();
    void settle_miss(std::size_t track);
    bool has_ended(const Track& track) const;
    void summarise();
    void remember(std::size_t track, const double* mean, const double* covariance);
    bool is_published(std::size_t track) const;
    void publish_tracks(std::int64_t time);
    void publish_smoothed(std::int64_t time);
    void tell_measurements(const Outcome& outcome, std::uint64_t id, pelorus::TrackEntry& entry);
    void check_joint() const;

    bool counts_scans() const noexcept { return misses == Misses::per_scan && !late_; }
    void count(const char* name, std::size_t by) const;

    Models models_;
    std::string frame_;
    std::optional<pelorus::TracksBuilder> message_;
    pelorus::InnovationsBuilder innovations_;
    const plr_diagnostics* diagnostics_ = nullptr;
    const plr_log* log_ = nullptr;

    // the scan at hand
    std::int64_t scan_time_ = 0;
    bool late_ = false;
    Detections detections_;
    Gating gating_;
    JointUpdate joint_;
    std::vector<double> weights_;    // of the measurements told
    std::vector<Outcome> outcomes_;  // by track
    std::vector<char> taken_;        // by detection
    std::vector<Wanted> wanted_;
    std::vector<double> means_, covariances_;  // of `wanted_`

    // state
    TrackStore tracks_;
    std::uint64_t next_id_ = 1, step_ = 0;
    std::uint64_t confirmed_ = 0;                      // tracks that were, ever
    std::optional<std::int64_t> newest_, next_sweep_;  // ns
};

}  // namespace point_target
