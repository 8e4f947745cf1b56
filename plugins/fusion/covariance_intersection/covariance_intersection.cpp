// fusion.covariance_intersection: scans and tracks whose errors may be correlated in any way. See README.md.
#include "covariance_intersection_fusion.hpp"

PELORUS_PLUGIN(covariance_intersection::CovarianceIntersection, "fusion.covariance_intersection");
