// scheduler.echo: answers every message of tracks with a command that nobody obeys; enough to draw a circle of edges.
#include <pelorus/pelorus.hpp>

namespace {

struct EchoScheduler : pelorus::Stage<EchoScheduler> {
    static constexpr const char* kind = "scheduler";

    static void describe(pelorus::Describe<EchoScheduler>& plugin) {
        plugin.title("Echo").purpose("Publishes the number of tracks, for tests of feedback.");
        plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "to be counted");
        plugin.out_port("commands", PLR_MESSAGE_VALUES, "`tracks`, addressed to nobody");
    }

    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks) {
        pelorus::Vector<1> number;
        number(0) = static_cast<double>(tracks.count);
        pelorus::ValuesBuilder command;
        command.add("", "tracks", "", number, event.time);
        publish(0, command.message(event.time));
    }

    template <class Archive> void state(Archive&) {}
};

}  // namespace

PELORUS_PLUGIN(EchoScheduler, "scheduler.echo");
