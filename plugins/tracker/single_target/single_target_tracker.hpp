/// tracker.single_target: one target whose measurements need no association. See README.md.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/innovations.hpp>
#include <pelorus/stage.hpp>

#include "start.hpp"

namespace single_target {

enum class Start { measurement, given, drawn };

/// One measurement of a scan.
struct Measurement {
    std::uint64_t id = 0;
    std::int64_t time = 0;  ///< ns
    Eigen::VectorXd value;
    std::optional<Eigen::MatrixXd> noise;  ///< none: the sensor's own
    std::optional<double> snr;
};

/// The target, as far as it is known.
struct Track {
    std::uint64_t id = 0;
    std::int64_t time = 0;  ///< ns, of the record
    std::int32_t misses = 0;
    one_track::Record record;
    template <class Archive> void state(Archive& archive) { archive(id, time, misses, record); }
};

class SingleTargetTracker : public pelorus::Stage<SingleTargetTracker> {
public:
    static constexpr const char* kind = "tracker";
    enum InPort : std::uint32_t { scans_in, truth_in, inputs_in };
    enum OutPort : std::uint32_t { tracks_out, innovations_out };

    static void describe(pelorus::Describe<SingleTargetTracker>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const;

    void on_scan(const pelorus::Event& event, const plr_scan& scan);
    void on_truth(const pelorus::Event& event, const plr_truth& truth);
    void on_values(const pelorus::Event& event, const plr_values& values);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        std::uint64_t size = filter_.record_size();
        std::uint32_t layout = filter_.record_version();
        archive(size, layout, step_, next_id_, started_, truth_, track_, filter_.caller);
        if constexpr (Archive::reading) check_state(size, layout);
    }

private:
    static void describe_start(pelorus::Describe<SingleTargetTracker>& plugin);
    void check_start() const;
    void check_state(std::uint64_t size, std::uint32_t layout) const;

    /// A scan, step by step.
    void read(const pelorus::Event& event, const plr_scan& scan);
    void start_known(std::int64_t time);
    void start_from(const Measurement& measurement, const plr_scan& scan);
    void follow(const Measurement& measurement, const plr_scan& scan);
    void follow_late(const Measurement& measurement, const plr_scan& scan);
    void use(const Measurement& measurement, const plr_scan& scan, Track& track);
    void settle(std::int64_t time);
    void begin_track(std::int64_t time, const Known& known);
    void move(Track& track, std::int64_t time);
    Kinematics given_start() const;

    void tell(std::int64_t time, std::int32_t status);
    void give_up(const pelorus::Failure& failure);
    one_track::At at(std::int64_t time, std::uint64_t id) const;
    void count(const char* name) const;
    void warn(const std::string& line) const;
    void warn_once(bool& told, const std::string& line) const;

    Start start_ = Start::measurement;
    std::optional<std::vector<double>> start_position_, start_velocity_, start_acceleration_;  // m, m/s, m/s2
    std::optional<std::vector<double>> start_sd_;                                              // m, m/s, m/s2
    std::optional<std::int64_t> maximum_misses_;
    bool records_ = false, anew_ = false;

    one_track::Filter filter_;
    std::unique_ptr<pelorus::TracksBuilder> message_;
    pelorus::InnovationsBuilder innovations_;
    const plr_random* random_ = nullptr;
    const plr_diagnostics* diagnostics_ = nullptr;
    const plr_log* log_ = nullptr;
    plr_key key_{};
    std::string frame_, estimator_id_;

    // the scan at hand
    int sensor_ = -1;
    std::vector<Measurement> measurements_;
    std::vector<std::uint64_t> used_;
    std::vector<double> distances_;
    bool begun_ = false;  ///< the track, in this scan, by what is known beforehand

    bool told_late_ = false, told_failure_ = false;

    // state
    std::uint64_t step_ = 0, next_id_ = 1;
    bool started_ = false;            ///< once, ever: what is given or drawn starts no second track
    std::optional<TrueStart> truth_;  ///< kept until the start, and not a moment longer
    std::optional<Track> track_;
};

}  // namespace single_target
