/* Pelorus ABI: how a stage sends. */
#ifndef PELORUS_ABI_PUBLISH_H
#define PELORUS_ABI_PUBLISH_H

#include "message.h"
#include "status.h"

#define PLR_SERVICE_PUBLISH "pelorus.publish/1"

typedef struct plr_publish {
  uint32_t struct_size;
  uint32_t reserved;
  void* context;
  /* [worker, exclusive] From within receive, emit or finish of the same stage. Copies the message and queues it for all
   * edges of the out port (its index in the description). PLR_E_ARGUMENT: no such port, another kind, shapes that do not
   * agree. Only a source may set an arrival, not before the one being handled. */
  plr_status (*publish)(void* context, uint32_t port, const plr_message* message, plr_error* error);
} plr_publish;

#endif
