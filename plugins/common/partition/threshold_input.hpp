/// The threshold of a partition by distance as an input: a tracker that has d0 among its own parameters hands it on by this, and a
/// stage may change it while it runs.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include <pelorus/describe.hpp>
#include <pelorus/failure.hpp>
#include <pelorus/setup.hpp>

namespace partition {

/// Declares it; the plugin's only input.
template <class Plugin> void describe_threshold_input(pelorus::Describe<Plugin>& plugin) {
    plugin.input("threshold", "m", {0.0}, "d0 in place of the parameter; 0: the parameter");
}

/// The one in force, m. Throws ArgumentError for one that is no distance.
inline double threshold_in_force(const pelorus::InputTable& inputs, const plr_call& call, double parameter) {
    const double given = *inputs(call, 0, 0);
    if (given == 0) return parameter;
    if (!(given >= 1e-9 && given <= 1e15))
        throw pelorus::ArgumentError("input threshold: is " + std::to_string(given) + " m, expected 1e-9 to 1e15 m");
    return given;
}

}  // namespace partition
