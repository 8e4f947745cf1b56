/// registration.least_squares: the stream of one sensor at the times of another, by a polynomial. See README.md.
#pragma once

#include "../../common/streams/onto_times.hpp"

namespace least_squares {

class LeastSquares : public streams::OntoTimes<LeastSquares> {
public:
    static constexpr std::size_t spared = 0;  // no sample tells of two times

    static void describe(pelorus::Describe<LeastSquares>& plugin);
    void prepare();
    streams::Clock patience() const noexcept { return 0; }
    /// `samples`: those since the last time, and perhaps some after `time`.
    std::optional<streams::Estimate> tell(const streams::SampleBuffer::Samples& samples, streams::Clock time,
                                          const pelorus::Space& space) const;

private:
    int order_ = 1;
    int min_samples_ = 4;
    std::optional<double> window_;  // s
    std::optional<streams::Clock> window_ns_;
};

}  // namespace least_squares
