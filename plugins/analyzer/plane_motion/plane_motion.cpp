// analyzer.plane_motion as a plugin. See README.md.
#include "plane_analyzer.hpp"

PELORUS_PLUGIN(plane_motion::PlaneAnalyzer, "analyzer.plane_motion");
