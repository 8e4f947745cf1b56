// analyzer.tracking_error: estimates against truth. See README.md.
#include "tracking_error.hpp"

PELORUS_PLUGIN(tracking_error::TrackingError, "analyzer.tracking_error");
