/// registration.block_mean: blocks of a fast stream, each told as one measurement. See README.md.
#pragma once

#include <deque>

#include "../../common/streams/held_scan.hpp"

namespace block_mean {

using streams::Clock;

enum class Others { held, passed };

class BlockMean : public pelorus::Stage<BlockMean>, public streams::Intake {
public:
    static constexpr const char* kind = "registration";

    static void describe(pelorus::Describe<BlockMean>& plugin);
    void setup(const pelorus::Setup& setup);
    std::vector<pelorus::Stream> in_streams(std::uint32_t port) const;
    // The stream keeps its name, space and frame; all others come out as they came in.
    std::uint32_t passes_on(std::uint32_t) const { return 1; }

    void on_scan(const pelorus::Event& event, const plr_scan& scan);
    void finish(const pelorus::Event& event);

    template <class Archive> void state(Archive& archive) {
        intake_state(archive);
        archive(held_, closed_, last_arrival_);
    }

private:
    /// A scan of another sensor, until all blocks before it have been told.
    struct Held {
        streams::HeldScan scan;
        Clock deadline = 0;  ///< ns, arrival
        template <class Archive> void state(Archive& archive) { archive(scan, deadline); }
    };

    /// The end of the block that a time lies in: blocks are (k period, (k + 1) period].
    Clock block_end(Clock time) const;
    bool is_closed(Clock time) const { return closed_ && time <= *closed_; }
    /// The end of the last block that is closed as soon as something arrives at `arrival`, if one is.
    std::optional<Clock> silent_until(Clock arrival) const;
    void take(const pelorus::Event& event, const plr_scan& scan);
    void hold(const pelorus::Event& event, const plr_scan& scan);
    void close_until(std::optional<Clock> end);
    void release_until(Clock time);
    /// Tells the block of the first `count` samples, after the scans that come before it.
    void tell_block(std::size_t count);

    double period_ = 0.5;  // s
    int min_samples_ = 1;
    Others others_ = Others::held;
    Clock period_ns_ = 0;

    // What save keeps, besides the intake.
    std::deque<Held> held_;              ///< in the order of their times
    std::optional<Clock> closed_;        ///< the end of the last closed block
    std::optional<Clock> last_arrival_;  ///< of the stream
};

}  // namespace block_mean
