// fusion.information: scans and tracks as sums of information. See README.md.
#include "information_fusion.hpp"

PELORUS_PLUGIN(information::InformationFusion, "fusion.information");
