// registration.calibration: estimates how a sensor is mounted and timed wrongly against another one, and takes it off. See README.md.
#include "calibration_stage.hpp"

PELORUS_PLUGIN(calibration::CalibrationStage, "registration.calibration");
