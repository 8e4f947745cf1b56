// partitioner.statistical: measurements that a chain of statistically short links joins are one cell. See README.md.
#include "statistical.hpp"

PELORUS_PLUGIN(statistical::Statistical, "partitioner.statistical");
