// tracker.track_then_group as a plugin. See README.md.
#include "track_then_group_tracker.hpp"

PELORUS_PLUGIN(track_then_group::TrackThenGroupTracker, "tracker.track_then_group");
