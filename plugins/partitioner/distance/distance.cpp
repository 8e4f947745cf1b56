// partitioner.distance: measurements that a chain of short links joins are one cell. See README.md.
#include "distance.hpp"

PELORUS_PLUGIN(distance::Distance, "partitioner.distance");
