// trajectory.segments: accelerations, level turns and vertical loops one after the other, in closed form. See README.md.
#include "segments.hpp"

PELORUS_PLUGIN(segments::Segments, "trajectory.segments");
