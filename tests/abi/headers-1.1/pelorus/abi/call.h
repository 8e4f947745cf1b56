/* Pelorus ABI: what accompanies every model call and every stage call.
 *
 * A holder (an estimator, a tracker) passes the same context on to the parts it calls, shifted by slices where it works
 * through a batch in blocks: item_ids, keys, inputs and item_status then point to the block's first item and
 * item_offset grows by as much, so that error.item keeps naming the item of the outermost batch.
 */
#ifndef PELORUS_ABI_CALL_H
#define PELORUS_ABI_CALL_H

#include "log.h"
#include "random.h"
#include "status.h"
#include "view.h"

/* A stack of bytes. A callee takes from data + used (16-byte aligned), raises `used`, and restores it before it returns. */
typedef struct plr_scratch {
  unsigned char* data; /* aligned to 64 bytes */
  uint64_t size;
  uint64_t used;
} plr_scratch;

typedef struct plr_call {
  uint32_t struct_size;
  uint32_t reserved;
  int64_t time;             /* ns; the time that the outputs are for */
  int64_t item_offset;      /* index, within the outermost batch, of item 0 here */
  const uint64_t* item_ids; /* [count] stable ids (track ids, object ids), or NULL: the indices are the ids */
  const plr_key* keys;      /* [count] random keys, or NULL where nothing is drawn */
  const double* inputs;     /* the inputs of all models of the holder's tree; a model reads from its own
                               plr_config.input_offset on. NULL: every input has its default */
  int64_t input_stride;     /* doubles from one item's inputs to the next one's; 0: common to all */
  plr_scratch* scratch;     /* at least info.scratch_bytes free, which are 16 MiB at most */
  plr_error* error;         /* never NULL */
  plr_status* item_status;  /* [count], PLR_OK on entry, or NULL where the caller wants only the first failure */
  const plr_log* log;       /* or NULL */
} plr_call;

#endif
