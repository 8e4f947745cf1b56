/// source.udp: scans and truth that come in as UDP datagrams. See README.md.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../../common/wire/decode.hpp"
#include <pelorus/stage.hpp>

#include "receiver.hpp"
#include "sequencer.hpp"

namespace source_udp {

enum class Arrival { frame, clock };
enum class BadFrames { stop, skip };
enum class Truth { none, position, velocity, acceleration };

class UdpSource : public pelorus::Stage<UdpSource> {
public:
    static constexpr const char* kind = "source";
    enum Port : std::uint32_t { scans, truth };

    static void describe(pelorus::Describe<UdpSource>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> out_streams(std::uint32_t port) const;

    plr_next next();
    void emit(const pelorus::Event& event);
    void finish(const pelorus::Event& event);

    /// A datagram as if it had come in from `origin`; `now`: ns of a clock that only goes forward.
    void take(std::string_view bytes, const std::string& origin, std::int64_t now);

    template <class Archive> void state(Archive& archive) {
        archive(*sequencer_, counted_, told_, next_id_);
        if constexpr (Archive::reading) has_waited_ = false;
    }

private:
    struct Counts {
        std::uint64_t datagrams = 0, frames = 0, rows = 0, bad = 0, refused = 0, overrun = 0;
        template <class Archive> void state(Archive& archive) {
            archive(datagrams, frames, rows, bad, refused, overrun);
        }
    };

    static void describe_socket(pelorus::Describe<UdpSource>& plugin);
    static void describe_order(pelorus::Describe<UdpSource>& plugin);
    static void describe_limits(pelorus::Describe<UdpSource>& plugin);
    void open();
    void drain(std::int64_t now);
    void refuse(const std::string& text);
    void warn(const std::string& text);
    void log(int level, const std::string& line) const;
    void tell(const char* name, std::uint64_t value);
    void tell_counters();
    void publish_scan(const wire::Frame& frame);
    void publish_truth(const wire::Frame& frame);

    // parameters
    std::int64_t port_ = 0;
    std::optional<std::string> address_, multicast_, interface_;
    std::int64_t receive_buffer_ = 0, senders_ = 1;
    std::optional<double> idle_;  // s
    double reorder_seconds_ = 0;
    std::int64_t reorder_datagrams_ = 0, maximum_senders_ = 1, maximum_measurements_ = 1, maximum_pending_ = 1;
    Arrival arrival_ = Arrival::frame;
    Late late_ = Late::drop;
    Lost lost_ = Lost::count;
    Duplicates duplicates_ = Duplicates::drop;
    BadFrames bad_frames_ = BadFrames::stop;
    Truth truth_kind_ = Truth::none;
    std::int64_t truth_axes_ = 3;

    ReceiverSettings where_;
    wire::Vocabulary vocabulary_;
    Receiver receiver_;
    const plr_log* log_ = nullptr;
    const plr_diagnostics* diagnostics_ = nullptr;
    std::int64_t last_heard_ = 0;  // of the clock that only goes forward, ns
    bool has_waited_ = false;
    std::uint32_t overrun_before_ = 0;
    std::uint64_t warnings_ = 0;

    // state
    std::unique_ptr<Sequencer> sequencer_;
    Counts counted_;
    std::map<std::string, std::uint64_t> told_;  // what the host's counters say
    std::uint64_t next_id_ = 1;
};

}  // namespace source_udp
