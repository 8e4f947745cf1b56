/* Pelorus ABI: the log. Plugins never carry a logging library of their own: two copies in one process have two
 * registries and, with some of them, one corrupted heap. The host adds time, node and plugin id. */
#ifndef PELORUS_ABI_LOG_H
#define PELORUS_ABI_LOG_H

#include "threads.h"

#define PLR_SERVICE_LOG "pelorus.log/1"

enum { PLR_LOG_TRACE = 0, PLR_LOG_DEBUG = 1, PLR_LOG_INFO = 2, PLR_LOG_WARNING = 3, PLR_LOG_ERROR = 4 };

typedef struct plr_log {
  uint32_t struct_size;
  int32_t level; /* messages below it are dropped: look before you format */
  void* context;
  /* [any] One line of UTF-8, copied. Not hot: a hot call reports by status. */
  void (*write)(void* context, int32_t level, const char* text);
} plr_log;

#endif
