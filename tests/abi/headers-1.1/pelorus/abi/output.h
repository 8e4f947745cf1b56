/* Pelorus ABI: where a run's files go. Results proper are messages (tables); a sink writes files beside them. */
#ifndef PELORUS_ABI_OUTPUT_H
#define PELORUS_ABI_OUTPUT_H

#include "threads.h"

#define PLR_SERVICE_OUTPUT "pelorus.output/1"

typedef struct plr_output {
  uint32_t struct_size;
  uint32_t reserved;
  void* context;
  /* [any] The result folder: absolute, there before the first message comes. NULL while nothing is run (`pelorus check`) or where
   * the run keeps no files. Lives as long as the instance. A sink writes nothing before its first message or finish. */
  const char* (*folder)(void* context);
} plr_output;

#endif
