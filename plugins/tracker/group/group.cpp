// tracker.group: groups of objects, each followed as a whole. See README.md.
#include "group_tracker.hpp"

PELORUS_PLUGIN(group::GroupTracker, "tracker.group");
