/// sink.udp: sends scans, truth and tracks as UDP datagrams. See README.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "../../common/wire/encode.hpp"
#include <pelorus/stage.hpp>

#include "sender.hpp"

namespace sink_udp {

enum class Format { json, csv };
enum class SendErrors { stop, count };

class UdpSink : public pelorus::Stage<UdpSink> {
public:
    static constexpr const char* kind = "sink";
    static void describe(pelorus::Describe<UdpSink>& plugin);
    void setup(const pelorus::Setup& setup);

    void on_scan(const pelorus::Event& event, const plr_scan& scan);
    void on_truth(const pelorus::Event& event, const plr_truth& truth);
    void on_tracks(const pelorus::Event& event, const plr_tracks& tracks);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        archive(envelope_.session, envelope_.sequence);
        if constexpr (Archive::reading) start_.reset();
    }

private:
    /// Where pacing counts from.
    struct Start {
        std::int64_t arrival = 0, clock = 0;  // ns
    };

    void send(const pelorus::Event& event, const wire::Datagrams& datagrams);
    void send(const std::string& datagram);
    void wait_for(std::int64_t arrival);
    void open();
    void require_json(const char* port) const;
    void count(const char* name, std::int64_t by) const;
    void log(int level, const std::string& line) const;

    // parameters
    std::string destination_text_, sender_name_;
    Format format_ = Format::json;
    wire::Uncertainty uncertainty_ = wire::Uncertainty::deviations;
    SendErrors send_errors_ = SendErrors::count;
    std::int64_t maximum_datagram_ = 1400, repeat_end_ = 3;
    double pace_ = 0;
    std::optional<std::string> interface_;

    Destination destination_;
    Sender sender_;
    const plr_log* log_ = nullptr;
    const plr_diagnostics* diagnostics_ = nullptr;
    std::optional<Start> start_;
    bool hurried_ = false;  // a signal came while waiting: somebody wants an end
    std::uint64_t told_errors_ = 0;
    std::int64_t sent_ = 0, not_sent_ = 0;

    // state
    wire::Envelope envelope_;
};

}  // namespace sink_udp
