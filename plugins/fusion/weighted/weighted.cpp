// fusion.weighted: scans and tracks fused by the reciprocals of their (co)variances. See README.md.
#include "weighted_fusion.hpp"

PELORUS_PLUGIN(weighted::WeightedFusion, "fusion.weighted");
