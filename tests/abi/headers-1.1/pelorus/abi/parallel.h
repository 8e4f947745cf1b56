/* Pelorus ABI: work on many cores. The host owns the threads; a plugin starts none. */
#ifndef PELORUS_ABI_PARALLEL_H
#define PELORUS_ABI_PARALLEL_H

#include "call.h"

#define PLR_SERVICE_PARALLEL "pelorus.parallel/1"

typedef struct plr_parallel {
  uint32_t struct_size;
  uint32_t threads; /* at most so many bodies run at once */
  void* context;
  /* [worker, concurrent] The one wait that a hot call may make. Runs body(argument, first, last, scratch) over [0, count) in blocks of `block` items whose bounds do
   * not depend on the number of threads; returns when all are done. The first failing block (in order) decides the
   * answer. A body must not call run() again. */
  plr_status (*run)(void* context, int64_t count, int64_t block,
                    plr_status (*body)(void* argument, int64_t first, int64_t last, plr_scratch* scratch,
                                       plr_error* error),
                    void* argument, plr_error* error);
} plr_parallel;

#endif
