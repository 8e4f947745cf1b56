/// The calls of a sensor, each made of the arguments that it is given.
#pragma once

#include "machine/arguments.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance::sensor_calls {

inline const plr_sensor& table(const Instance& instance) { return instance.table<plr_sensor>(); }
inline const plr_sensor_info& info(const Instance& instance) { return *table(instance).info(instance.self()); }

HotCall measure(const Instance& instance, const Argument& cartesian);
HotCall jacobian(const Instance& instance, const Argument& cartesian);
/// For `count` items; cartesian, snr and waveform may be absent.
HotCall noise(const Instance& instance, std::int64_t count, const Argument& cartesian, const Argument& snr,
              const Argument& waveform);
/// The reference may have one column or as many as the measurement.
HotCall residual(const Instance& instance, const Argument& measurement, const Argument& reference);
/// Without `with_covariance` the mean alone is asked for.
HotCall invert(const Instance& instance, const Argument& measurement, const Argument& noise,
               bool with_covariance = true);

/// Places that the sensor measures: plausible ones, drawn again where measure refuses an item. Fails the check where it refuses
/// all of many.
Argument places(const Instance& instance, Sample& sample, std::int64_t count);
/// Values near those that the waveform's space declares; absent where the sensor has none.
Argument waveforms(const Instance& instance, Sample& sample, std::int64_t count);
/// An output of a call as an input of the next one.
Argument as_input(const char* name, const HotCall& call, const Execution& done, std::size_t output);

}  // namespace pelorus::conformance::sensor_calls
