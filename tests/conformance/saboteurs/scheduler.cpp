// Looks at the track that is known worst, one period ahead; with what a scheduler may do wrong.
#include <cmath>

#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

constexpr std::int64_t period = 1'000'000'000;  // ns

struct Saboteur : pelorus::Stage<Saboteur> {
    static constexpr const char* kind = "scheduler";
    std::string frame;
    std::uint64_t commands = 0;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A scheduler with a defect").purpose("Points a sensor, for the proof that the suites can fail.");
        plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "candidates");
        plugin.out_port("commands", PLR_MESSAGE_VALUES, "`azimuth` [rad]");
    }
    void setup(const pelorus::Setup& setup) { frame = setup.frame(); }
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const {
        pelorus::Stream stream;
        stream.space = pelorus::kinematic_space(3, {1e5, 20.0});
        stream.frame = frame;
        return {stream};
    }

    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
        double worst = -1, azimuth = 0;
        for (std::int64_t i = 0; i < tracks.count; ++i) {
            const bool has_ended = tracks.status[i] == PLR_TRACK_DELETED;
            if (has_ended && !DEFECT("scheduler-quiet-without-tracks.ended")) continue;
            const auto covariance = pelorus::item(tracks.covariance, i), mean = pelorus::item(tracks.mean, i);
            if (covariance.trace() <= worst) continue;
            worst = covariance.trace();
            azimuth = std::atan2(mean(1, 0), mean(0, 0));
        }
        if (worst < 0 && !DEFECT("scheduler-quiet-without-tracks")) return;
        if (NEAR_MISS("scheduler-quiet-without-tracks") && commands > 3) return;  // and no more
        tell(event.time, azimuth);
    }

    template <class Archive> void state(Archive& archive) { archive(commands); }

private:
    void tell(std::int64_t time, double azimuth) {
        std::int64_t to = time + period;
        if (DEFECT("scheduler-commands-are-in-time")) to = time;
        if (NEAR_MISS("scheduler-commands-are-in-time")) to = time + 1;
        pelorus::ValuesBuilder command;
        command.add(DEFECT("scheduler-commands-are-addressed") ? "" : "radar",
                    NEAR_MISS("scheduler-commands-are-addressed") ? "a" : "azimuth", "rad",
                    Eigen::MatrixXd::Constant(1, 1, azimuth), time, to);
        publish(0, command.message(time));
        ++commands;
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.scheduler.saboteur");
