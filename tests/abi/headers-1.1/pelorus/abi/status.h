/* Pelorus ABI: what every call answers, and how an error is told.
 *
 * A call answers PLR_OK, PLR_ITEMS_FAILED (some items of a batch failed, the others are good) or a negative code.
 * The text goes to the caller's plr_error. Only the first error of a call is kept: a callee that finds `code` already
 * set leaves it alone. Text is UTF-8, one line, no final full stop.
 */
#ifndef PELORUS_ABI_STATUS_H
#define PELORUS_ABI_STATUS_H

#include "threads.h"

typedef int32_t plr_status;

enum {
  PLR_OK = 0,
  PLR_ITEMS_FAILED = 1,     /* see plr_call.item_status; outputs of failed items are undefined */
  PLR_E_ARGUMENT = -1,      /* the caller broke the contract: shape, NULL, struct_size */
  PLR_E_PARAMETER = -2,     /* a parameter's value is not acceptable; plr_error.where names it */
  PLR_E_PART = -3,          /* a part is missing, superfluous or does not fit; plr_error.where names its slot */
  PLR_E_CAPACITY = -4,      /* the caller's buffer is too small; the size needed has been answered */
  PLR_E_SCRATCH = -5,       /* less scratch memory than plr_*_info.scratch_bytes */
  PLR_E_UNSUPPORTED = -6,   /* this instance does not offer that (negative dt, say) */
  PLR_E_NUMERIC = -7,       /* not finite, not positive definite, did not converge */
  PLR_E_DATA = -8,          /* input from outside is malformed: a file, a message, saved state */
  PLR_E_STATE_VERSION = -9, /* a record or saved state of another version */
  PLR_E_IO = -10,           /* the operating system refused */
  PLR_E_MEMORY = -11,
  PLR_E_CANCELLED = -12, /* the host asked to stop */
  PLR_E_EXCEPTION = -13  /* an exception was caught at the boundary; its text is the message */
};

typedef struct plr_error {
  uint32_t struct_size;
  plr_status code;   /* PLR_OK: nothing told yet */
  int64_t item;      /* index within the outermost batch, or -1 */
  char where[128];   /* the parameter, slot or port concerned, or "" */
  char message[512]; /* always zero-terminated */
} plr_error;

/* What every plr_error has, of whatever version: nothing is written to a shorter one. */
#define PLR_ERROR_LEAST_SIZE (offsetof(plr_error, message) + 512)

#endif
