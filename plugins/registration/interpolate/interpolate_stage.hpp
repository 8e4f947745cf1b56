/// registration.interpolate: the stream of one sensor at the times of another, between neighbouring samples. See README.md.
#pragma once

#include "../../common/streams/onto_times.hpp"

namespace interpolate {

enum class Rule { linear, hermite };

class Interpolate : public streams::OntoTimes<Interpolate> {
public:
    static constexpr std::size_t spared = 2;  // before a time, for the next one and for going beyond them

    static void describe(pelorus::Describe<Interpolate>& plugin);
    void prepare();
    /// A time waits for the sample after it.
    streams::Clock patience() const noexcept { return max_gap_ns_; }
    std::optional<streams::Estimate> tell(const streams::SampleBuffer::Samples& samples, streams::Clock time,
                                          const pelorus::Space& space) const;

private:
    bool is_far(const streams::Sample& first, streams::Clock time) const { return time - first.time > max_gap_ns_; }

    Rule rule_ = Rule::linear;
    double max_gap_ = 1.0;  // s
    streams::Clock max_gap_ns_ = 0;
};

}  // namespace interpolate
