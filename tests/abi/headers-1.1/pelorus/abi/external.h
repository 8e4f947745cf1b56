/* Pelorus ABI: external: a source whose in ports an application feeds (libpelorus, <pelorus/embed.h>).
 *
 * Such a stage answers PLR_NEXT_END to next: it has no events of its own. What is pushed into one of its in ports reaches it
 * by receive, at the message's arrival, in the order of events (stage.h); before that the host has checked the message, and
 * that it is one of the streams that port_type answers for that in port.
 */
#ifndef PELORUS_ABI_EXTERNAL_H
#define PELORUS_ABI_EXTERNAL_H

#include "stage.h"

/* Extension of a stage instance. */
#define PLR_EXTERNAL "pelorus.stage.external/1"

/* What the host does with a message that arrives before an event that was handled already. */
enum {
  PLR_LATE_REFUSE = 0, /* whoever pushes it is told; counter `late_refused` */
  PLR_LATE_DROP = 1,   /* it is left out; counter `late_dropped` */
  PLR_LATE_KEEP = 2    /* it arrives now instead, with its own stamp; counter `late_kept` */
};

typedef struct plr_external {
  uint32_t struct_size;
  uint32_t late; /* PLR_LATE_... */
} plr_external;

#endif
