// partitioner.dbscan: clusters by density, and noise. See README.md.
#include "dbscan.hpp"

PELORUS_PLUGIN(dbscan::Dbscan, "partitioner.dbscan");
