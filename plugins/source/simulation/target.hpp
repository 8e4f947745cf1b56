/// A simulated target: a trajectory (of one object or a family), and how it is seen.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <pelorus/caller.hpp>
#include <pelorus/parts.hpp>

#include "draws.hpp"
#include "recording.hpp"

namespace simulation {

enum class Spread { gaussian, uniform };

/// What the config says of a target beyond its trajectory.
struct TargetValues {
    std::int64_t points_per_scan = 0;
    double detection_probability = 1;
    Spread spread = Spread::gaussian;
};

/// A living object at one time. Pointers into the target's block of states.
struct Object {
    const double* state = nullptr;    ///< c
    const double* extent = nullptr;   ///< d x d, m^2, or nullptr
    std::uint64_t id = 0, index = 0;  ///< over all targets; within its target
    std::uint64_t parent = 0;         ///< id; its own: none
    std::int64_t birth = 0;           ///< ns
    bool recorded = false;            ///< `state` is a recorded position, `measured` where it was measured, or nullptr
    const double* measured = nullptr;
};

using Middle = std::array<double, 3>;  ///< m; 0 on axes that there are not

class Target {
public:
    Target(const pelorus::TrajectoryPart& part, const TargetValues& values, std::uint64_t first_id)
        : part_(part),
          values_(values),
          space_(*part.info().state),
          first_id_(first_id),
          number_(number_of(part.name())) {
        while (axes_ < space_.size() && space_[axes_].name.rfind("position.", 0) == 0) ++axes_;
        const int d = part_.info().extent_dimension;
        if (d != 0 && d != axes_)
            throw pelorus::PartError("targets", "target " + name() + " has an extent of " + std::to_string(d) +
                                                    " dimensions and positions on " + std::to_string(axes_) + " axes");
        if (values_.points_per_scan > 0 && d == 0)
            throw pelorus::PartError("targets", "target " + name() + " gives " +
                                                    std::to_string(values_.points_per_scan) +
                                                    " points a scan but has no extent that they could lie on");
    }

    std::string name() const { return part_.name(); }
    std::uint64_t number() const noexcept { return number_; }
    const TargetValues& values() const noexcept { return values_; }
    const pelorus::Space& space() const noexcept { return space_; }
    int axes() const noexcept { return axes_; }
    int extent_dimension() const noexcept { return part_.info().extent_dimension; }
    std::int64_t objects() const noexcept { return part_.info().objects; }

    void realise(pelorus::Caller& caller, const Draws& draws) {
        record_.assign(static_cast<std::size_t>(part_.info().record_size), 0.0);
        const plr_key key = draws.key(PLR_STREAM_TRAJECTORY, {0, number_, 0, 0});
        const plr_view record = pelorus::view(record_.data(), part_.info().record_size, 1, 1);
        caller.require(part_.call(&plr_trajectory::realise, caller.begin(0, 1, nullptr, &key), record),
                       "target " + name() + ", realise");
    }

    /// Computes the states at these times (ns, ascending). One call for many times: a trajectory that integrates pays for the last only.
    void load_block(pelorus::Caller& caller, const std::int64_t* times, std::int64_t count) {
        const std::int64_t c = space_.size(), o = objects(), d = extent_dimension();
        block_times_ = count;
        states_.resize(static_cast<std::size_t>(c * count * o));
        extents_.resize(static_cast<std::size_t>(d * d * count * o));
        ids_.resize(static_cast<std::size_t>(o));
        parents_.resize(static_cast<std::size_t>(o));
        births_.resize(static_cast<std::size_t>(o));
        deaths_.resize(static_cast<std::size_t>(o));
        auto args = pelorus::arguments<plr_trajectory_states>();
        args.record = pelorus::const_view(record_.data(), part_.info().record_size, 1, 1);
        args.time_count = count;
        args.times = times;
        args.states = pelorus::view(states_.data(), c, count, o);
        if (d != 0) args.extents = pelorus::view(extents_.data(), d * d, count, o);
        args.ids = ids_.data();
        args.parents = parents_.data();
        args.births = births_.data();
        args.deaths = deaths_.data();
        caller.require(part_.call(&plr_trajectory::states, caller.begin(times[0], 1), args),
                       "target " + name() + ", states");
    }

    /// The living objects at time `t` of the block.
    void collect(std::int64_t t, std::vector<Object>& out) const {
        const std::int64_t c = space_.size(), d = extent_dimension();
        for (std::int64_t k = 0; k < objects(); ++k) {
            const double* state = states_.data() + (k * block_times_ + t) * c;
            if (!std::all_of(state, state + c, [](double x) { return std::isfinite(x); })) continue;
            Object object = member(k);
            object.state = state;
            object.extent = d == 0 ? nullptr : extents_.data() + (k * block_times_ + t) * d * d;
            out.push_back(object);
        }
    }
    /// The objects that a recording has at a tick, where it says that they are.
    void collect(const Recording& recording, std::uint64_t tick, std::vector<Object>& out) const {
        for (std::int64_t k = 0; k < objects(); ++k) {
            Object object = member(k);
            const std::uint64_t number = first_id_ - 1 + static_cast<std::uint64_t>(k);
            object.recorded = true;
            object.state = recording.truth(tick, number);
            object.measured = recording.measured(tick, number);
            if (object.state != nullptr) out.push_back(object);
        }
    }

    template <class Archive> void state(Archive& archive) {
        archive(record_);
        if constexpr (Archive::reading)
            if (record_.size() != static_cast<std::size_t>(part_.info().record_size))
                throw pelorus::DataError("the saved record of target " + name() + " is of another size");
    }

private:
    /// Who object k is.
    Object member(std::int64_t k) const {
        const auto index = static_cast<std::size_t>(k);
        Object object;
        object.index = ids_[index];
        object.id = first_id_ + ids_[index];
        object.parent = parents_[index] < 0 ? object.id : first_id_ + ids_[static_cast<std::size_t>(parents_[index])];
        object.birth = births_[index];
        return object;
    }

    pelorus::TrajectoryPart part_;
    TargetValues values_;
    pelorus::Space space_;
    std::uint64_t first_id_, number_;
    int axes_ = 0;
    std::vector<double> record_;
    std::int64_t block_times_ = 0;
    std::vector<double> states_, extents_;
    std::vector<std::uint64_t> ids_;
    std::vector<std::int64_t> parents_, births_, deaths_;
};

}  // namespace simulation
