/* Pelorus ABI: everything. Plugins in C include this; C++ authors include <pelorus/pelorus.hpp>. */
#ifndef PELORUS_ABI_ABI_H
#define PELORUS_ABI_ABI_H

#include "call.h"
#include "consistency.h"
#include "describe.h"
#include "diagnostics.h"
#include "entry.h"
#include "estimator.h"
#include "extent.h"
#include "external.h"
#include "frames.h"
#include "host.h"
#include "log.h"
#include "message.h"
#include "motion.h"
#include "output.h"
#include "parallel.h"
#include "partitioner.h"
#include "plugin.h"
#include "publish.h"
#include "random.h"
#include "record.h"
#include "sensor.h"
#include "space.h"
#include "stage.h"
#include "status.h"
#include "threads.h"
#include "trajectory.h"
#include "view.h"
#include "waveform.h"

#include "layout.h"

#endif
