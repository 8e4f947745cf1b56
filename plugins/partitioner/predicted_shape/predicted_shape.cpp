// partitioner.predicted_shape: of each prediction the measurements in the gate of its shape. See README.md.
#include "predicted_shape.hpp"

PELORUS_PLUGIN(predicted_shape::PredictedShape, "partitioner.predicted_shape");
