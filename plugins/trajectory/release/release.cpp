// trajectory.release: an object in free flight that releases decoys. See README.md.
#include "release.hpp"

PELORUS_PLUGIN(release::Release, "trajectory.release");
