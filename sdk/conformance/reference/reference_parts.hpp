/// The plugins that fill slots where a subject names none: each is a textbook's formula, short enough to be checked by reading it.
#pragma once

#include <pelorus/abi/plugin.h>

namespace pelorus::conformance {

const plr_plugin* reference_motion();
const plr_plugin* reference_sensor();

}  // namespace pelorus::conformance
