// tracker.extended_target: one extended target, all its measurements of each scan. See README.md.
#include "extended_target.hpp"

PELORUS_PLUGIN(extended_target::ExtendedTarget, "tracker.extended_target");
