// tracker.single_target: one target whose measurements need no association. See README.md.
#include "single_target_tracker.hpp"

PELORUS_PLUGIN(single_target::SingleTargetTracker, "tracker.single_target");
