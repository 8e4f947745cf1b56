// scheduler.pointing: points a narrow sensor at what a track predicts. See README.md.
#include "pointing_scheduler.hpp"

PELORUS_PLUGIN(pointing_scheduler::PointingScheduler, "scheduler.pointing");
