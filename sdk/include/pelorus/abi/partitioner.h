/* Pelorus ABI: partitioner: splits the measurements of one scan into cells.
 *
 * One call is one scan of M points in d dimensions (1 to 3). The answer is one alternative (or several, for set filters), each
 * a list of cells, each a list of members, as nested compressed rows in the caller's buffers. Within an alternative every point
 * is in exactly one cell (at least one, if the description says PLR_DESCRIPTION_OVERLAP); outliers are cells of one. Members of
 * a cell ascend. First come the cells of predictions, at most one each, in the order of the predictions; then the others, in the
 * order of their first members. Who draws random numbers uses keys[0]: a split is one item.
 */
#ifndef PELORUS_ABI_PARTITIONER_H
#define PELORUS_ABI_PARTITIONER_H

#include "parallel.h"
#include "plugin.h"

#define PLR_PARTITIONER "pelorus.partitioner/1"

typedef struct plr_partitioner_info {
  uint32_t struct_size;
  uint32_t flags;
  int32_t dimension_min, dimension_max;
  uint64_t scratch_bytes;       /* fixed share */
  uint64_t scratch_bytes_point; /* and so many for each point and prediction */
} plr_partitioner_info;

/* Predicted objects, where the tracker has some; count 0 otherwise. Passed by value: frozen as it is. */
typedef struct plr_predictions {
  int64_t count;
  const uint64_t* ids;       /* [count] */
  plr_const_view mean;       /* d x 1 x count, m */
  plr_const_view covariance; /* d x d x count, m^2: H P H' */
  plr_const_view extent;     /* d x d x count, m^2, or data NULL */
} plr_predictions;

/* Buffers of the caller; capacities in elements. */
typedef struct plr_partition {
  uint32_t struct_size;
  uint32_t reserved;
  int64_t alternative_capacity, cell_capacity, member_capacity;
  int64_t alternatives, cells, members; /* out; with PLR_E_CAPACITY: what is needed */
  int64_t* alternative_offsets;         /* [alternative_capacity + 1] into cells */
  double* alternative_weights;          /* [alternative_capacity] */
  int64_t* cell_offsets;                /* [cell_capacity + 1] into members */
  int64_t* cell_predictions;            /* [cell_capacity] index of the prediction a cell belongs to, or -1 */
  int64_t* member_points;               /* [member_capacity] index of the point */
  double* member_weights;               /* [member_capacity] sum 1 in a cell */
} plr_partition;

typedef struct plr_partitioner_split {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view points;     /* d x 1 x M, m */
  plr_const_view covariance; /* d x d x M, m^2; item_stride 0: common; data NULL: not known */
  plr_predictions predictions;
  const plr_parallel* parallel; /* or NULL; same bytes for any number of threads */
  plr_partition* out;
} plr_partitioner_split;

typedef struct plr_partitioner {
  plr_table_head head;
  /* [worker, concurrent] Constant while the instance lives. */
  const plr_partitioner_info* (*info)(const void* self);
  /* [worker, concurrent] [hot] */
  plr_status (*split)(const void* self, const plr_call* call, const plr_partitioner_split* args);
} plr_partitioner;

#endif
