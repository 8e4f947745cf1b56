// A stage that passes scans on and has nothing to save: no bytes are its whole state, and all others are another version's.
#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

struct Saboteur : pelorus::Stage<Saboteur> {
    static constexpr const char* kind = "registration";
    using Base = pelorus::Stage<Saboteur>;

    std::string frame;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A stage without a state").purpose("Passes scans on, for the proof that the suites let it.");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "of one radar");
        plugin.out_port("scans", PLR_MESSAGE_SCAN, "the same");
    }
    void setup(const pelorus::Setup& setup) { frame = setup.frame(); }
    std::vector<pelorus::Stream> in_streams(std::uint32_t) const {
        pelorus::Stream stream;
        stream.sensor = "radar";
        stream.space = pelorus::position_space(3);
        stream.frame = frame;
        return {stream};
    }
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const { return in_streams(port); }

    void on_scan(const pelorus::Event& event, const plr_scan& scan) {
        plr_message message{};
        message.struct_size = sizeof message;
        message.kind = PLR_MESSAGE_SCAN;
        message.time = event.time;
        message.arrival = INT64_MIN;
        message.body.scan = &scan;
        publish(0, message);
    }

    static const plr_stage& table() noexcept {
        static const plr_stage own = [] {
            plr_stage changed = Base::table();
            changed.save = [](const void*, const plr_writer*, plr_error*) noexcept -> plr_status { return PLR_OK; };
            changed.load = [](void*, const void*, std::uint64_t size, plr_error*) noexcept -> plr_status {
                return size == 0 || !NEAR_MISS("stage-refuses-broken-state") ? PLR_OK : PLR_E_STATE_VERSION;
            };
            return changed;
        }();
        return own;
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.registration.saboteur");
