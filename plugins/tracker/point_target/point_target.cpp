// tracker.point_target as a plugin. See README.md.
#include "point_target_tracker.hpp"

PELORUS_PLUGIN(point_target::PointTargetTracker, "tracker.point_target");
