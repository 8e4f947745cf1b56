/* Pelorus ABI: the host as a plugin sees it. One plr_host an instance: it carries the instance's identity. */
#ifndef PELORUS_ABI_HOST_H
#define PELORUS_ABI_HOST_H

#include "threads.h"

typedef struct plr_host {
  uint32_t struct_size;
  uint16_t abi_major, abi_minor;
  const char* version; /* of the host, for messages */
  void* context;
  /* [any] A service's table (log.h, random.h, publish.h, frames.h, parallel.h, output.h, diagnostics.h) or NULL: then do without,
   * or refuse to be created with PLR_E_UNSUPPORTED. Valid as long as the instance. */
  const void* (*service)(const struct plr_host* host, const char* id);
} plr_host;

#endif
