/* Pelorus ABI: stage: a node of the dataflow graph: source, registration, fusion, tracker, scheduler, analyzer, sink.
 * They share one table; the kinds differ in what they promise (see each function).
 *
 * A stage owns its state and can save and load it: after load(save(x)) it goes on bit for bit as x would have.
 *
 * The host runs a source so: next() says when its next event arrives; when that is the earliest of all, emit() publishes it.
 * So a command that reaches a simulation before the next event is obeyed by it. Everything else runs on received messages.
 *
 * A feedback edge, previous(x), delivers by receive, just before the stage's next emit or receive, all messages that x published
 * strictly before that arrival and that it has not delivered yet, oldest first; the last one is the newest.
 *
 * A source publishes the truth of a tick before the scans of that tick.
 */
#ifndef PELORUS_ABI_STAGE_H
#define PELORUS_ABI_STAGE_H

#include "message.h"
#include "plugin.h"
#include "publish.h"

#define PLR_STAGE "pelorus.stage/1"

/* One stream through a port. */
typedef struct plr_stream {
  uint32_t struct_size;
  uint32_t flags;
  const char* sensor;     /* scans: the sensor's name; "" for tracks, truth; NULL on an in port: any */
  const plr_space* space; /* NULL: any (in ports only) */
  const char* frame;      /* NULL: any (in ports only); "" : the root frame */
} plr_stream;

enum {
  PLR_STREAM_AT_LEAST = 1u << 0 /* in ports: the offered space may have further components after or between these */
};

/* What a port carries. An offered stream must match a stream of the in port of the same sensor name or, failing that, one with
 * sensor NULL; otherwise the graph is refused and both sides are printed. No streams on an in port: everything is welcome. */
typedef struct plr_port_type {
  uint32_t struct_size;
  uint32_t stream_count;
  const plr_stream* streams;
  uint32_t
      passes_on; /* out ports: 1 + index of an in port whose streams come out here, too; 0: none. A stream listed here
                         replaces the one of the same sensor name */
  uint32_t reserved;
} plr_port_type;

enum { PLR_NEXT_DATA = 1, PLR_NEXT_WAIT = 2, PLR_NEXT_END = 3 };

typedef struct plr_next {
  uint32_t struct_size;
  uint32_t what;
  int64_t arrival; /* ns: of the next event (DATA), or wall-clock time (ns since the Unix epoch) to ask again (WAIT) */
  int64_t time;    /* ns: its stamp, for the order of events that arrive together */
} plr_next;

/* Where save writes. */
typedef struct plr_writer {
  uint32_t struct_size;
  uint32_t reserved;
  void* context;
  /* [worker, exclusive] Copies. */
  plr_status (*write)(void* context, const void* bytes, uint64_t size, plr_error* error);
} plr_writer;

typedef struct plr_stage {
  plr_table_head head;
  /* [main] What an in port wants or an out port carries. The answer lives as long as the instance. NULL: everything. */
  plr_status (*port_type)(const void* self, uint32_t is_output, uint32_t port, plr_port_type* out, plr_error* error);
  /* [worker, exclusive] Sources only: what comes next. Does not publish; asked again before each event, so it must be cheap. */
  plr_status (*next)(void* self, const plr_call* call, plr_next* out);
  /* [worker, exclusive] Sources only: publishes the event that next announced. call.time is its arrival. */
  plr_status (*emit)(void* self, const plr_call* call);
  /* [worker, exclusive] A message has come in at an in port. call.time is the arrival of the event being
   * handled: the message's own, but on a feedback edge. PLR_E_DATA: it is refused and counted,
   * the state is as before, the run goes on; any other error ends the run. */
  plr_status (*receive)(void* self, const plr_call* call, uint32_t port, const plr_message* message);
  /* [worker, exclusive] No more will come. Publish what is left; sinks make their files complete. Called in graph order; what
   * it publishes is received before the next node's finish. */
  plr_status (*finish)(void* self, const plr_call* call);
  /* [worker, exclusive] All state, behind a version number of the stage's own. NULL: it has none. */
  plr_status (*save)(const void* self, const plr_writer* writer, plr_error* error);
  /* [worker, exclusive] Takes such state over, whole or (on any error) not at all. */
  plr_status (*load)(void* self, const void* bytes, uint64_t size, plr_error* error);
} plr_stage;

#endif
