// analyzer.shape_error: estimated ellipsoids against true ones. See README.md.
#include "shape_error.hpp"

PELORUS_PLUGIN(shape_error::ShapeError, "analyzer.shape_error");
