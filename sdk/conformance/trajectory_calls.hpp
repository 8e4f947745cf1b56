/// The calls of a trajectory.
#pragma once

#include <cstdint>
#include <vector>

#include "machine/arguments.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance::trajectory_calls {

inline const plr_trajectory& table(const Instance& instance) { return instance.table<plr_trajectory>(); }
inline const plr_trajectory_info& info(const Instance& instance) { return *table(instance).info(instance.self()); }

/// What is random about one realisation: an argument of `states`. Fails the check unless realise goes well.
Argument realised(const Instance& instance, plr_key key);

/// Outputs of `states`. The last four are arrays of 64-bit integers, carried as doubles of the same bits.
enum Output : std::size_t { states_out, extents_out, ids_out, parents_out, births_out, deaths_out };

/// One item an object; not a batch by nature. The times must be ascending.
HotCall states(const Instance& instance, const Argument& record, const std::vector<std::int64_t>& times,
               bool with_extents);

/// Times from 0 on, a different step apart each.
std::vector<std::int64_t> ascending_times(Sample& sample, std::int64_t count, double longest_step);

}  // namespace pelorus::conformance::trajectory_calls
