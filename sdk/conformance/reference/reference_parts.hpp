/// The plugins that fill slots where a subject names none: each is a textbook's formula, short enough to be checked by reading it.
#pragma once

#include <pelorus/abi/plugin.h>

namespace pelorus::conformance {

const plr_plugin* reference_motion();
const plr_plugin* reference_sensor();
const plr_plugin* reference_estimator();
const plr_plugin* reference_extent();
const plr_plugin* reference_partitioner();
const plr_plugin* reference_waveform();
const plr_plugin* reference_trajectory();

}  // namespace pelorus::conformance
