// fusion.weighted: one scan of several sensors', weighted by the reciprocals of their variances. See README.md.
#include "weighted_fusion.hpp"

PELORUS_PLUGIN(weighted::WeightedFusion, "fusion.weighted");
