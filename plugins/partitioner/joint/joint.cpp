// partitioner.joint: of each prediction the measurements in its gate, split by distance once more. See README.md.
#include "joint.hpp"

PELORUS_PLUGIN(joint::Joint, "partitioner.joint");
