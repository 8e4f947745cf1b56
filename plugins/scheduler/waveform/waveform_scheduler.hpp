/// scheduler.waveform: chooses a sensor's next waveform from the prediction of a track. See README.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pelorus/stage.hpp>

#include "../../common/one_track/filter.hpp"

namespace waveform_scheduler {

enum class Policy { worst, first };

class WaveformScheduler : public pelorus::Stage<WaveformScheduler> {
public:
    static constexpr const char* kind = "scheduler";
    enum InPort : std::uint32_t { tracks_in, scans_in };
    enum OutPort : std::uint32_t { commands_out, choices_out };

    static void describe(pelorus::Describe<WaveformScheduler>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;

    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks);
    void on_scan(const pelorus::Event& event, const plr_scan& scan);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        archive(last_look_, spacing_, choices_, filter_.caller);
        if constexpr (Archive::reading)
            if (choices_.size() % columns() != 0) throw pelorus::DataError("saved choices are of another waveform");
    }

private:
    void find_sensor();
    void check_waveform() const;
    std::size_t width() const { return static_cast<std::size_t>(waveform_.info().waveform->size); }
    std::size_t columns() const { return width() + 2; }
    /// The entry to look after, or -1.
    std::int64_t chosen_track(const plr_tracks& tracks) const;
    void see_look(std::int64_t time);
    /// The waveform, then the criterion.
    Eigen::VectorXd choose(std::int64_t step, one_track::At now, one_track::Record record);
    void publish_command(std::int64_t time, std::int64_t look, std::int64_t step, const Eigen::VectorXd& waveform);

    std::optional<std::string> sensor_name_;
    std::optional<double> period_;  // s
    Policy policy_ = Policy::worst;

    one_track::Filter filter_;
    std::vector<int> positions_;  ///< components of a track that are positions
    pelorus::WaveformPart waveform_;
    std::string unit_;  ///< of a command: those of the waveform's parameters
    int sensor_ = 0;
    bool looks_by_scans_ = false;  ///< scans come in: they tell the rhythm, tracks do not
    std::string frame_;
    const plr_random* random_ = nullptr;
    plr_key key_{};

    // What save keeps.
    std::optional<std::int64_t> last_look_;  ///< ns
    std::optional<std::int64_t> spacing_;    ///< ns, between the last two looks
    std::vector<double> choices_;            ///< rows of the table `choices`
};

}  // namespace waveform_scheduler
