// sink.bench_nothing: takes scans and does nothing with them.
#include <pelorus/pelorus.hpp>

namespace {

struct Nothing : pelorus::Stage<Nothing> {
    static constexpr const char* kind = "sink";

    static void describe(pelorus::Describe<Nothing>& plugin) {
        plugin.title("Nothing").purpose("Takes scans and forgets them, for measuring the runtime.");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "what is forgotten");
    }
    void on_scan(const pelorus::Event&, const plr_scan&) {}
};

}  // namespace

PELORUS_PLUGIN(Nothing, "sink.bench_nothing");
