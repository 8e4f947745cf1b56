/// source.external: publishes what an application pushes. See README.md.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <pelorus/abi/external.h>
#include <pelorus/stage.hpp>

namespace source_external {

enum class Late { refuse, drop, keep };

class ExternalSource : public pelorus::Stage<ExternalSource> {
public:
    static constexpr const char* kind = "source";
    /// Of in and out ports alike: what comes in at one goes out at its namesake.
    enum Port : std::uint32_t { scans, truth, tracks, values };

    static void describe(pelorus::Describe<ExternalSource>& plugin) {
        plugin.title("What an application pushes")
            .purpose(
                "The place in a graph where an application that embeds Pelorus puts in its own scans (and truth, "
                "tracks, values): what is pushed into an in port comes out of the out port of the same name. The "
                "sensors say which scans may come. The command pushes nothing, so a graph that has only such sources "
                "ends at once there.");
        plugin.parameter("late", &ExternalSource::late_)
            .initially("refuse")
            .choices({{"refuse", "the application is told, and it is counted (late_refused)"},
                      {"drop", "it is left out and counted (late_dropped)"},
                      {"keep", "it arrives now, with its own stamp, and is counted (late_kept)"}})
            .doc("what happens to a message that arrives before one that was handled already");
        plugin.slot("sensors", "sensor", 0, -1,
                    "whose scans may come, by name; their spaces are those of the scans. None: any scan may come");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "pushed by the application", PLR_PORT_OPTIONAL);
        plugin.in_port("truth", PLR_MESSAGE_TRUTH, "pushed by the application", PLR_PORT_OPTIONAL);
        plugin.in_port("tracks", PLR_MESSAGE_TRACKS, "pushed by the application", PLR_PORT_OPTIONAL);
        plugin.in_port("values", PLR_MESSAGE_VALUES, "pushed by the application", PLR_PORT_OPTIONAL);
        plugin.out_port("scans", PLR_MESSAGE_SCAN, "scans as they were pushed");
        plugin.out_port("truth", PLR_MESSAGE_TRUTH, "truth as it was pushed; that of a tick before its scans");
        plugin.out_port("tracks", PLR_MESSAGE_TRACKS, "tracks as they were pushed");
        plugin.out_port("values", PLR_MESSAGE_VALUES, "values as they were pushed");
    }

    void setup(const pelorus::Setup& setup) {
        log_ = setup.optional_service<plr_log>();
        frame_ = setup.frame();
        for (const pelorus::SensorPart& part : setup.parts<pelorus::SensorPart>("sensors")) {
            pelorus::Stream stream;
            stream.sensor = part.name();
            stream.space = pelorus::Space(*part.info().measurement);
            stream.frame = frame_;
            sensors_.push_back(stream);
        }
        external_.late = static_cast<std::uint32_t>(late_);
    }

    const void* extension(const char* id) const noexcept {
        return std::strcmp(id, PLR_EXTERNAL) == 0 ? &external_ : nullptr;
    }

    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const { return streams(port); }
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const { return streams(port); }

    plr_next next() { return {sizeof(plr_next), PLR_NEXT_END, 0, 0}; }
    void emit(const pelorus::Event&) {}

    void on_scan(const pelorus::Event& event, const plr_scan& scan) { pass_on(event, PLR_MESSAGE_SCAN, &scan); }
    void on_truth(const pelorus::Event& event, const plr_truth& told) { pass_on(event, PLR_MESSAGE_TRUTH, &told); }
    void on_tracks(const pelorus::Event& event, const plr_tracks& told) { pass_on(event, PLR_MESSAGE_TRACKS, &told); }
    void on_values(const pelorus::Event& event, const plr_values& told) { pass_on(event, PLR_MESSAGE_VALUES, &told); }

    void finish(const pelorus::Event&) {
        if (received_ == 0 && log_ != nullptr && log_->level <= PLR_LOG_WARNING)
            log_->write(log_->context, PLR_LOG_WARNING,
                        "nothing was pushed: this node publishes what an application pushes into it (libpelorus); "
                        "`pelorus run` has nothing to push");
    }

    template <class Archive> void state(Archive& archive) { archive(received_); }

private:
    std::vector<pelorus::Stream> streams(std::uint32_t port) const {
        return port == scans ? sensors_ : std::vector<pelorus::Stream>();
    }

    void pass_on(const pelorus::Event& event, std::uint32_t kind_of_body, const void* body) {
        plr_message message = pelorus::detail::message_of(kind_of_body, event.time);
        std::memcpy(&message.body, &body, sizeof body);
        publish(event.port, message);
        ++received_;
    }

    Late late_ = Late::refuse;
    std::vector<pelorus::Stream> sensors_;
    std::string frame_;
    plr_external external_{sizeof(plr_external), PLR_LATE_REFUSE};
    const plr_log* log_ = nullptr;

    std::uint64_t received_ = 0;  // state
};

}  // namespace source_external
