/// The calls of a motion, each made of the arguments that it is given.
#pragma once

#include "machine/arguments.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance::motion_calls {

inline const plr_motion& table(const Instance& instance) { return instance.table<plr_motion>(); }
inline const plr_motion_info& info(const Instance& instance) { return *table(instance).info(instance.self()); }

/// Arguments must stand in the order of their names, with the items that they are to have; absent() where they are not given.
HotCall propagate(const Instance& instance, const Argument& dt, const Argument& state, const Argument& record,
                  const Argument& mean);
HotCall jacobian(const Instance& instance, const Argument& dt, const Argument& state, const Argument& record,
                 const Argument& mean);
HotCall noise(const Instance& instance, const Argument& dt, const Argument& state, const Argument& covariance,
              const Argument& predicted, const Argument& extent, const Argument& record);
/// As noise, through the extension PLR_MOTION_NOISE_FACTOR, which the instance must offer.
HotCall noise_factor(const Instance& instance, const Argument& dt, const Argument& state, const Argument& covariance,
                     const Argument& predicted, const Argument& extent, const Argument& record);
/// F1 and Q1 of the extension PLR_MOTION_STRUCTURE, which the instance must offer, for one dt.
HotCall blocks(const Instance& instance, double dt);
HotCall init_record(const Instance& instance, const Argument& state, const Argument& covariance);
HotCall advance_record(const Instance& instance, const Argument& dt, const Argument& state, const Argument& covariance,
                       const Argument& record);
HotCall to_cartesian(const Instance& instance, const Argument& state);
HotCall from_cartesian(const Instance& instance, const Argument& cartesian);

/// The records that init_record makes of states and covariances; absent where the motion keeps none.
Argument initial_records(const Instance& instance, const Argument& state, const Argument& covariance);
/// Extents of some ten metres for a motion that uses them; else absent.
Argument extents(const Instance& instance, Sample& sample, std::int64_t count);

}  // namespace pelorus::conformance::motion_calls
