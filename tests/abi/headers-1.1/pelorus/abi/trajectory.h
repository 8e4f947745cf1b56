/* Pelorus ABI: trajectory: the true motion and shape of one object or of a family of objects, for simulation.
 *
 * Letters: o objects at most, c state components (canonical order), T times, r doubles of record, d dimensions.
 * What is random about it is drawn once, by realise; states is then a function of the record and the times.
 */
#ifndef PELORUS_ABI_TRAJECTORY_H
#define PELORUS_ABI_TRAJECTORY_H

#include "plugin.h"

#define PLR_TRAJECTORY "pelorus.trajectory/1"

typedef struct plr_trajectory_info {
  uint32_t struct_size;
  uint32_t flags;
  const plr_space* state;   /* c: positions, velocities[, accelerations] */
  int64_t objects;          /* o */
  int32_t extent_dimension; /* d, or 0: points */
  uint32_t record_version;
  int64_t record_size;    /* r */
  uint64_t scratch_bytes; /* for any N (work in blocks), the largest need of its parts included */
} plr_trajectory_info;

typedef struct plr_trajectory_states {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view record; /* r x 1 x 1 */
  int64_t time_count;    /* T */
  const int64_t* times;  /* [T] ns since the start of the run, ascending */
  plr_view states;       /* c x T x o; NaN while an object does not exist */
  plr_view extents;      /* (d d) x T x o: matrices as in plr_extent_shape, m^2, column-major; data NULL: not wanted */
  uint64_t* ids;         /* [o] 0 .. o - 1, unique within the trajectory */
  int64_t* parents;      /* [o] index of the object it came from, or -1 */
  int64_t* births;       /* [o] ns */
  int64_t* deaths;       /* [o] ns, INT64_MAX: never */
} plr_trajectory_states;

typedef struct plr_trajectory {
  plr_table_head head;
  /* [worker, concurrent] Constant while the instance lives. */
  const plr_trajectory_info* (*info)(const void* self);
  /* [worker, concurrent] Draws the random part with call.keys[0] into a record, r x 1 x 1. */
  plr_status (*realise)(const void* self, const plr_call* call, const plr_view* record);
  /* [worker, concurrent] [hot] Costs as much as the last time is far from the start: ask for many times at once. */
  plr_status (*states)(const void* self, const plr_call* call, const plr_trajectory_states* args);
} plr_trajectory;

#endif
