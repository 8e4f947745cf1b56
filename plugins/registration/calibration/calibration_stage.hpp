/// registration.calibration: estimates how a sensor is mounted and timed wrongly against another one, and takes it off. See README.md.
#pragma once

#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pelorus/messages.hpp>
#include <pelorus/stage.hpp>

#include "pairing.hpp"
#include "track_correction.hpp"

namespace calibration {

inline std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

enum class Mode { augmented, schmidt };
enum class Spread { kept, widened };
enum class Corrected { scans, tracks };

class CalibrationStage : public pelorus::Stage<CalibrationStage> {
public:
    static constexpr const char* kind = "registration";
    enum InPort : std::uint32_t { scans_in, tracks_in };
    enum OutPort : std::uint32_t { scans_out, tracks_out, values_out, biases_out };

    static void describe(pelorus::Describe<CalibrationStage>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;
    std::uint32_t passes_on(std::uint32_t port) const {
        return port == scans_out ? 1 + scans_in : port == tracks_out ? 1 + tracks_in : 0;
    }

    void on_scan(const pelorus::Event& event, const plr_scan& scan);
    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        archive(biases_, pose_, frames_, waiting_, last_fixes_, seen_, newest_frame_, newest_fix_, last_pair_, pairs_,
                observable_since_, rows_, row_spacing_, next_row_);
        if constexpr (Archive::reading) check_state();
    }

    /// What has been learnt up to now.
    const Biases& biases() const noexcept { return biases_; }

private:
    /// A row of the table `biases` for each bias.
    struct Row {
        std::int64_t time = 0;  ///< ns
        BiasVector value, deviation, presence, observable;
        template <class Archive> void state(Archive& archive) { archive(time, value, deviation, presence, observable); }
    };
    /// All fixes of one scan of the reference.
    using Fixes = std::vector<Fix>;

    void check_parts(const std::vector<pelorus::SensorPart>& parts);
    void check_biases(const BiasVector& deviations) const;
    void check_state() const;

    void take_reference(const pelorus::Event& event, const plr_scan& scan);
    void take_sensor(const pelorus::Event& event, const plr_scan& scan);
    Frame frame_of(const pelorus::Event& event, const plr_scan& scan);
    bool is_repeated(std::int64_t time, std::uint64_t id);

    void publish_scan(std::int64_t time, const plr_scan& scan);
    void publish_corrected(const pelorus::Event& event, const plr_scan& scan, const Frame& frame);
    /// What of the estimate is taken off scans, or off tracks; in Schmidt's mode nothing is, and all of it is spread.
    Estimate applied_to(Corrected what) const;
    /// False where nothing can be said of this measurement yet.
    bool correct(const Sample& sample, const Estimate& estimate, Eigen::VectorXd& value, Eigen::MatrixXd& noise);
    Eigen::Vector3d place_of(const Sample& sample);

    void learn(const pelorus::Event& event);
    bool learn_from(const Fixes& fixes);
    void forget();
    void note_observable(std::int64_t time);
    void add_rows(std::int64_t time);
    Row row_at(std::int64_t time) const;
    void publish_values(std::int64_t time);
    void publish_directions(std::int64_t time);
    bool is_observable(int bias) const { return biases_.ratio(bias) <= observable_; }
    void count(const char* name) const;

    static constexpr double not_yet = std::numeric_limits<double>::quiet_NaN();

    // Parameters.
    std::optional<std::string> reference_name_, sensor_name_;
    Mode mode_ = Mode::augmented;
    Spread spread_ = Spread::widened;
    Corrected corrected_ = Corrected::scans;
    Eigen::Matrix<double, 3, 1> attitude_sd_, position_sd_;  // rad, m
    double range_sd_ = 0, clock_sd_ = 0;                     // m, s
    double presence_ = 0.5, observable_ = 0.5;
    double window_ = 1, lateness_ = 2;  // s
    double gate_ = 5, maximum_speed_ = 100;
    double every_ = 10;  // s

    pelorus::Caller caller_;
    SensorModel reference_, sensor_;
    PairingRule rule_;
    std::int64_t lateness_ns_ = 0;
    std::string frame_name_, bias_units_;
    const plr_diagnostics* diagnostics_ = nullptr;
    const plr_log* log_ = nullptr;

    // What save keeps.
    Biases biases_;
    std::optional<Pose> pose_;   ///< of the sensor without biases, once a fix has told a place to look from
    std::deque<Frame> frames_;   ///< ascending times
    std::deque<Fixes> waiting_;  ///< until frames surround them
    Fixes last_fixes_;           ///< of the newest scan that had some
    std::deque<std::pair<std::int64_t, std::uint64_t>> seen_;  ///< time and first id of recent scans
    std::optional<std::int64_t> newest_frame_, newest_fix_;    ///< ns
    std::optional<std::int64_t> last_pair_;                    ///< ns, of the newest fix learnt from
    std::uint64_t pairs_ = 0;
    BiasVector observable_since_ = BiasVector::Constant(not_yet);  ///< s
    std::vector<Row> rows_;
    std::int64_t row_spacing_ = 0, next_row_ = 0;  ///< ns
};

}  // namespace calibration
