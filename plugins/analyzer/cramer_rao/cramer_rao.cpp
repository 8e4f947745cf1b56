// analyzer.cramer_rao: the bound of any estimator on a trajectory. See README.md.
#include "cramer_rao.hpp"

PELORUS_PLUGIN(cramer_rao::CramerRao, "analyzer.cramer_rao");
