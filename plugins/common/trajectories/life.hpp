/// When the only object of a trajectory exists, and what a trajectory of one object answers of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <pelorus/batch_model.hpp>

namespace trajectories {

/// Seconds as ns. Throws ParameterError where a clock of ns cannot tell them.
inline std::int64_t nanoseconds(const char* parameter, double seconds) {
    if (!(seconds < 9e9))
        throw pelorus::ParameterError(parameter, "is beyond what a clock of nanoseconds can tell (9e9 s)");
    return std::llround(seconds * 1e9);
}

/// Parameters `birth` and `death` [s] of a plugin that derives from this.
class Life {
public:
    template <class Plugin> static void describe_life(pelorus::Describe<Plugin>& plugin) {
        plugin.parameter("birth", &Life::birth_).unit("s").initially("0 s").min(0).doc("when it appears, at `start`");
        plugin.parameter("death", &Life::death_).unit("s").above(0).doc("from when on it is gone; absent: never");
    }

protected:
    void begin_life() {
        birth_ns_ = nanoseconds("birth", birth_);
        if (death_ && *death_ <= birth_) throw pelorus::ParameterError("death", "must be after birth");
        death_ns_ = death_ ? nanoseconds("death", *death_) : std::numeric_limits<std::int64_t>::max();
    }
    std::int64_t birth() const noexcept { return birth_ns_; }  ///< ns

    /// Answers one object without parent, and calls write(t, seconds since birth) for each time (index t) at which it exists;
    /// states and extents of the others become not a number. Throws ArgumentError for wrong views.
    template <class Write>
    void answer(const plr_trajectory_states& args, std::int64_t components, std::int64_t dimension,
                Write&& write) const {
        pelorus::expect(args.states, components, args.time_count, 1, "states");
        const std::int64_t shape = args.extents.data == nullptr ? 0 : dimension * dimension;
        if (args.extents.data != nullptr) pelorus::expect(args.extents, shape, args.time_count, 1, "extents");
        args.ids[0] = 0;
        args.parents[0] = -1;
        args.births[0] = birth_ns_;
        args.deaths[0] = death_ns_;
        for (std::int64_t t = 0; t < args.time_count; ++t) {
            const std::int64_t time = args.times[t];
            if (time >= birth_ns_ && time < death_ns_) {
                write(t, static_cast<double>(time - birth_ns_) * 1e-9);
                continue;
            }
            std::fill_n(args.states.data + t * args.states.col_stride, components, pelorus::not_a_number);
            if (shape > 0) std::fill_n(args.extents.data + t * args.extents.col_stride, shape, pelorus::not_a_number);
        }
    }

private:
    double birth_ = 0;
    std::optional<double> death_;
    std::int64_t birth_ns_ = 0, death_ns_ = 0;
};

/// Throws ParameterError unless a vector has an element for each axis of `start`.
inline void check_axes(const char* parameter, std::size_t size, int axes) {
    if (static_cast<int>(size) != axes)
        throw pelorus::ParameterError(parameter,
                                      "has " + std::to_string(size) + " elements, start has " + std::to_string(axes));
}

}  // namespace trajectories
