/// The calls of a waveform model, with plausible arguments.
#pragma once

#include <vector>

#include <pelorus/space.hpp>

#include "machine/arguments.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance::waveform_calls {

inline const plr_waveform& table(const Instance& instance) { return instance.table<plr_waveform>(); }
inline const plr_waveform_info& info(const Instance& instance) { return *table(instance).info(instance.self()); }

/// Outputs of choose.
enum Output : std::size_t { chosen_waveform, chosen_noise, chosen_criterion };

/// What a scheduler knows: predictions over the horizon in Cartesian components, how the sensor sees them, its base noise.
struct Outlook {
    Space cartesian;
    Argument mean, covariance, projected, cross, base_noise, dt;
};

/// Of a target in components that the model takes (two or three axes, with or without accelerations). Fails the check where it
/// takes none.
Outlook sample_outlook(const Instance& instance, Sample& sample, std::int64_t count);
HotCall choose(const Instance& instance, const Outlook& outlook, bool has_criterion = true);

/// Waveforms about the base, within what the model calls a deviation; the model may refuse some.
Argument sample_waveforms(const Instance& instance, Sample& sample, std::int64_t count);
/// The base waveform, for every item.
Argument base_waveforms(const Instance& instance, std::int64_t count);
HotCall noise(const Instance& instance, const Argument& waveforms, const Argument& base_noise);

}  // namespace pelorus::conformance::waveform_calls
