/// Samples of a stream in the order of their stamps, whatever the order in which they came; never more than so many.
#pragma once

#include <deque>

#include "sample.hpp"

namespace streams {

class SampleBuffer {
public:
    using Samples = std::deque<Sample>;
    enum class Came { in_order, out_of_order, twice };

    /// A second sample of one stamp is left out: a sensor sees its object once at a time.
    Came insert(Sample sample) {
        auto at = samples_.end();
        while (at != samples_.begin() && std::prev(at)->time >= sample.time) --at;
        if (at != samples_.end() && at->time == sample.time) return Came::twice;
        const Came came = at == samples_.end() ? Came::in_order : Came::out_of_order;
        samples_.insert(at, std::move(sample));
        return came;
    }
    /// Answers whether the oldest had to go.
    bool keep_at_most(std::size_t capacity) {
        if (samples_.size() <= capacity) return false;
        samples_.pop_front();
        return true;
    }
    /// Forgets all samples up to `time`, the last `spared` of them excepted.
    void forget_until(Clock time, std::size_t spared) {
        while (samples_.size() > spared && samples_[spared].time <= time) samples_.pop_front();
    }
    const Samples& samples() const noexcept { return samples_; }

    template <class Archive> void state(Archive& archive) {
        archive(samples_);
        if constexpr (Archive::reading)
            for (std::size_t i = 1; i < samples_.size(); ++i)
                if (samples_[i - 1].time >= samples_[i].time) throw pelorus::DataError("saved samples are in disorder");
    }

private:
    Samples samples_;
};

}  // namespace streams
