/* Pelorus ABI: counters and gauges of a running plugin (rejected rows, gate sizes, iterations), shown with the results.
 * Not for results: those are messages. */
#ifndef PELORUS_ABI_DIAGNOSTICS_H
#define PELORUS_ABI_DIAGNOSTICS_H

#include "threads.h"

#define PLR_SERVICE_DIAGNOSTICS "pelorus.diagnostics/1"

typedef struct plr_diagnostics {
  uint32_t struct_size;
  uint32_t reserved;
  void* context;
  /* [any] Adds to a counter. The name is copied; it starts at 0. */
  void (*count)(void* context, const char* name, int64_t by);
  /* [any] Sets a gauge. */
  void (*gauge)(void* context, const char* name, const char* unit, double value);
} plr_diagnostics;

#endif
