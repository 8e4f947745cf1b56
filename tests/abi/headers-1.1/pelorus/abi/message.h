/* Pelorus ABI: messages: what flows along the edges of the graph.
 *
 * A stage builds a message in its own memory and publishes it (publish.h); the host copies it. A received message is borrowed
 * for the call. Pointers may be NULL where the count is 0 or the field says so. One message may hold entries of several times.
 * Strings live as long as the message.
 */
#ifndef PELORUS_ABI_MESSAGE_H
#define PELORUS_ABI_MESSAGE_H

#include "space.h"
#include "view.h"

#define PLR_MESSAGES "pelorus.message/1"

enum {
  PLR_MESSAGE_SCAN = 1,
  PLR_MESSAGE_TRACKS = 2,
  PLR_MESSAGE_TRUTH = 3,
  PLR_MESSAGE_VALUES = 4,
  PLR_MESSAGE_TABLE = 5
};

/* Measurements of one sensor at one time. */
typedef struct plr_scan {
  uint32_t struct_size;
  uint32_t reserved;
  const char* sensor;
  const char* frame;      /* of the Cartesian components that the sensor model reads, not of the sensor's own axes */
  const plr_space* space; /* m components */
  plr_const_view measurements;     /* m x 1 x n */
  plr_const_view covariances;      /* m x m x n; item_stride 0: common; data NULL: the sensor model's own noise holds */
  const uint64_t* ids;             /* [n] unique among all measurements that this source ever publishes */
  const int64_t* times;            /* [n] ns, or NULL: all at the message's time */
  plr_const_view snr;              /* 1 x 1 x n, power ratio, or data NULL */
  const plr_space* waveform_space; /* or NULL */
  plr_const_view waveform;         /* w x 1 x 1: the waveform in force, or data NULL */
} plr_scan;

enum { PLR_TRACK_TENTATIVE = 0, PLR_TRACK_CONFIRMED = 1, PLR_TRACK_COASTING = 2, PLR_TRACK_DELETED = 3 };

/* Estimates; n entries. A track that has ended is told once more, as DELETED. */
typedef struct plr_tracks {
  uint32_t struct_size;
  uint32_t record_version;
  int64_t count;
  const char* frame;
  const plr_space* space;        /* c components, positions first */
  const uint64_t* ids;           /* [n], unique within the publishing node, never used again within a run */
  const int64_t* times;          /* [n] ns */
  const int32_t* status;         /* [n] */
  const int32_t* misses;         /* [n] in a row */
  plr_const_view mean;           /* c x 1 x n */
  plr_const_view covariance;     /* c x c x n */
  plr_const_view extent;         /* d x d x n as in plr_extent_shape, or data NULL */
  const int64_t* parent_offsets; /* [n + 1] into parents, or NULL */
  const uint64_t*
      parents;            /* ids of all tracks that it directly came from, told with every entry; a survivor of a merger
                                    gains the id that it absorbed */
  const uint64_t* groups; /* [n] id of the group (an entry of the node's port `groups`), 0: none; or NULL */
  const int64_t* measurement_offsets; /* [n + 1] into measurements, or NULL */
  const uint64_t* measurements;       /* ids of the measurements used at this time */
  plr_const_view
      records; /* r x 1 x n estimator records, where the tracker's parameter `records` asks for them, or data NULL */
  const char* record_of;               /* plugin id of the estimator they belong to, or NULL */
  const double* measurement_distances; /* squared Mahalanobis distance of each of `measurements`, or NULL */
  const double* measurement_weights;   /* association weight of each of `measurements`, or NULL: 1 */
} plr_tracks;

/* What really is; n entries. */
typedef struct plr_truth {
  uint32_t struct_size;
  uint32_t reserved;
  int64_t count;
  const char* frame;
  const plr_space* space;             /* c components, positions first */
  const uint64_t* ids;                /* [n] */
  const int64_t* times;               /* [n] ns */
  plr_const_view state;               /* c x 1 x n */
  plr_const_view extent;              /* d x d x n, or data NULL */
  const uint64_t* parents;            /* [n] id, or the entry's own id: none; NULL: none at all */
  const int64_t* births;              /* [n] ns, or NULL */
  const int64_t* measurement_offsets; /* [n + 1] into measurements, or NULL */
  const uint64_t* measurements;       /* ids of the measurements that came from this object; the others are clutter */
} plr_truth;

/* A named quantity. Addressed to a sensor (its name as in plr_scan.sensor) it is a command; addressed to a model of the
 * receiver's tree (`estimator.motion`) it is an input. */
typedef struct plr_quantity {
  uint32_t struct_size;
  uint32_t reserved;
  const char* address; /* "" : whoever knows the name */
  const char* name;
  const char* unit;             /* one for all elements, or "m, rad, rad" a row */
  plr_const_view numbers;       /* rows x cols x 1, or one item for each of `ids` */
  int64_t valid_from, valid_to; /* ns; INT64_MIN, INT64_MAX: always */
  const uint64_t* ids;          /* [numbers.count] the tracks that it is for, or NULL: for all */
} plr_quantity;

typedef struct plr_values {
  uint32_t struct_size;
  uint32_t count;
  const plr_quantity* quantities; /* [count] */
} plr_values;

/* How a column or scalar of one run becomes one of many runs. Rows of different runs meet by their KEY columns. */
enum {
  PLR_REDUCE_KEY = 0,
  PLR_REDUCE_MEAN = 1,
  PLR_REDUCE_ROOT_MEAN_SQUARE = 2,
  PLR_REDUCE_SUM = 3,
  PLR_REDUCE_COUNT = 4, /* of finite values */
  PLR_REDUCE_MIN = 5,
  PLR_REDUCE_MAX = 6,
  PLR_REDUCE_QUANTILE = 7,
  PLR_REDUCE_FIRST_RUN = 8 /* only run 0's is kept */
};

typedef struct plr_column {
  uint32_t struct_size;
  uint32_t reduce;
  const char* name;
  const char* unit;
  double quantile;          /* for QUANTILE */
  const char* const* texts; /* a text column: element (row) is texts[number], numbers count from 0; else NULL */
  uint32_t text_count;
  uint32_t reserved;
} plr_column;

typedef struct plr_scalar {
  uint32_t struct_size;
  uint32_t reduce; /* of `value`; not used where `column` is given */
  const char* name;
  const char* unit;
  double value; /* of this run; NaN is left out and counted */
  double quantile;
  const char*
      column;    /* or NULL. Given: the scalar is the mean of that reduced column of this table over its rows (so that
                         an RMSE is the mean over time of the root mean square over runs); rows that reduce to nothing finite
                         are left out */
  double weight; /* of this run in a MEAN; 0 reads as 1 */
} plr_scalar;

/* A result. It reaches the results without any edge. A node may publish several tables of different names, and the same name
 * again: it replaces. */
typedef struct plr_table {
  uint32_t struct_size;
  uint32_t column_count;
  const char* name;          /* `by_time`; "" : only scalars */
  const plr_column* columns; /* [column_count] */
  plr_const_view rows;       /* column_count x 1 x rows */
  const plr_scalar* scalars; /* [scalar_count] */
  uint32_t scalar_count;
  uint32_t reserved;
} plr_table;

typedef struct plr_message {
  uint32_t struct_size;
  uint32_t kind;
  int64_t time;      /* ns: the stamp */
  int64_t arrival;   /* ns: when it reached us. On publishing: INT64_MIN = with the event being handled */
  uint64_t sequence; /* set by the host */
  union {
    const plr_scan* scan;
    const plr_tracks* tracks;
    const plr_truth* truth;
    const plr_values* values;
    const plr_table* table;
  } body;
  const char* origin; /* name of the publishing node; set by the host */
  uint32_t edge;      /* index among the edges that end at this in port, in file order; set by the host */
  uint32_t reserved;
} plr_message;

#endif
