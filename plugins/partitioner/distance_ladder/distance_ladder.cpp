// partitioner.distance_ladder: partitions by a ladder of distances, as alternatives. See README.md.
#include "distance_ladder.hpp"

PELORUS_PLUGIN(distance_ladder::DistanceLadder, "partitioner.distance_ladder");
