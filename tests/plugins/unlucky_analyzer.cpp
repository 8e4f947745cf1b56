// analyzer.unlucky: fails at the end of some runs, which the run's random key decides, and takes its time on the way.
#include <chrono>
#include <stdexcept>
#include <thread>

#include <pelorus/pelorus.hpp>

namespace {

struct UnluckyAnalyzer : pelorus::Stage<UnluckyAnalyzer> {
    static constexpr const char* kind = "analyzer";

    static void describe(pelorus::Describe<UnluckyAnalyzer>& plugin) {
        plugin.title("Unlucky").purpose("Fails in some runs, for tests of campaigns.");
        plugin.parameter("chance", &UnluckyAnalyzer::chance).min(0).max(1).initially("0").doc("of a failure in a run");
        plugin.parameter("pause", &UnluckyAnalyzer::pause).unit("s").min(0).initially("0 s").doc("of each message");
        plugin.in_port("truth", PLR_MESSAGE_TRUTH, "to be looked at");
        plugin.out_port("luck", PLR_MESSAGE_TABLE, "the number that was drawn");
    }

    void setup(const pelorus::Setup& setup) {
        // The key is spread over all its bits: its upper half is a number between 0 and 1.
        drawn_ = static_cast<double>(setup.key().word[0] >> 11) * 0x1p-53;
    }

    void on_truth(const pelorus::Event&, const plr_truth&) {
        if (pause > 0) std::this_thread::sleep_for(std::chrono::duration<double>(pause));
    }

    void finish(const pelorus::Event& event) {
        if (drawn_ < chance) throw std::runtime_error("out of luck");
        pelorus::ResultBuilder table("luck");
        table.scalar("drawn", "", PLR_REDUCE_MEAN, drawn_);
        publish(0, table.message(event.time));
    }

    template <class Archive> void state(Archive&) {}

    double chance = 0, pause = 0;

private:
    double drawn_ = 0;
};

}  // namespace

PELORUS_PLUGIN(UnluckyAnalyzer, "analyzer.unlucky");
