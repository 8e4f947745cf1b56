/* Pelorus ABI: extent: the shape of an extended target or of a group.
 *
 * Letters: d dimensions (2 or 3), r doubles of record, N items (objects). Points are Cartesian positions (m) in the tracker's
 * frame, ragged: those of item i are columns offsets[i] .. offsets[i + 1] - 1 of `points`.
 *
 * An extent knows the object's shape; an estimator beside it knows the kinematics. Where the two cannot be separated (Koch
 * 2008, Lan-Li, MEM-EKF*), the instance offers the extension `joint` and owns both; the tracker then holds no estimator.
 */
#ifndef PELORUS_ABI_EXTENT_H
#define PELORUS_ABI_EXTENT_H

#include "sensor.h"

#define PLR_EXTENT "pelorus.extent/1"

enum {
  PLR_EXTENT_NO_MEMORY = 1u << 16 /* the shape is what the newest scan alone says; it does not improve with time */
};

typedef struct plr_extent_info {
  uint32_t struct_size;
  uint32_t flags;       /* PLR_EXTENT_... */
  int32_t dimension;    /* d */
  int32_t start_scans;  /* how many scans init wants; the record is valid at the time of the last of them, and there the
                           kinematics begin, too. A tracker that starts by differencing two scans begins at the first scan if
                           this is 1, and at the second, with the covariance that effective_noise implies, if it is 2 */
  int32_t start_points; /* fewer points than so in a start scan: init fails with PLR_E_NUMERIC */
  uint32_t record_version;
  int64_t record_size;
  uint64_t scratch_bytes; /* for any N (work in blocks), the largest need of its parts included */
} plr_extent_info;

/* "Centroid" everywhere means the weighted mean of an item's points. Passed by value: this struct is frozen as it is. */
typedef struct plr_extent_points {
  const int64_t* offsets; /* [N + 1] */
  plr_const_view points;  /* d x 1 x total */
  plr_const_view noise;   /* d x d x total: R of each point; item_stride 0: common to all */
  plr_const_view weights; /* 1 x 1 x total, sum 1 within an item; data NULL: 1/n each */
} plr_extent_points;

typedef struct plr_extent_init {
  uint32_t struct_size;
  uint32_t scans;                /* = info.start_scans */
  const plr_extent_points* scan; /* [scans], oldest first */
  plr_const_view times;          /* scans x 1 x 1, s, relative to the first scan */
  plr_view record;               /* r x 1 x N */
} plr_extent_init;

typedef struct plr_extent_predict {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view dt; /* 1 x 1 x N, s */
  plr_const_view
      before; /* c x 1 x N: kinematics before the step, canonical order (positions, velocities, ...), c >= 2 d */
  plr_const_view before_covariance; /* c x c x N, or data NULL: not known */
  plr_const_view after;             /* c x 1 x N: and predicted */
  plr_const_view after_covariance;  /* c x c x N, or data NULL */
  plr_const_view record;            /* r x 1 x N */
  plr_view out;                     /* r x 1 x N; may be `record` itself */
} plr_extent_predict;

typedef struct plr_extent_effective_noise {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view record; /* r x 1 x N */
  plr_const_view noise;  /* d x d x N: sensor noise R of one point; the weighted mean where they differ */
  plr_const_view number; /* 1 x 1 x N: points averaged, 1 / sum w^2 where they are weighted; 1 for a single point */
  plr_view out;          /* d x d x N: covariance of the centroid about the object's centre, without H P H' */
} plr_extent_effective_noise;

typedef struct plr_extent_update {
  uint32_t struct_size;
  uint32_t reserved;
  plr_extent_points scan;
  plr_const_view innovation;            /* d x 1 x N: centroid - predicted position */
  plr_const_view innovation_covariance; /* d x d x N: S = H P H' + effective noise */
  plr_const_view kinematics;            /* c x 1 x N: posterior */
  plr_const_view kinematics_covariance; /* c x c x N, or data NULL: not known */
  plr_const_view record;                /* r x 1 x N; predicted */
  plr_view out;                         /* r x 1 x N; may be `record` itself. An item without points is copied */
  plr_view log_likelihood;              /* 1 x 1 x N: of the points' spread, or data NULL */
} plr_extent_update;

typedef struct plr_extent_shape {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view record; /* r x 1 x N */
  plr_view
      matrix; /* d x d x N, m^2: symmetric positive definite; (p - centre)' matrix^-1 (p - centre) = 1 is the outline */
  plr_view half_axes; /* d x 1 x N, m, descending, or data NULL */
  plr_view axes;      /* d x d x N: unit vectors of the half axes as columns, or data NULL */
} plr_extent_shape;

typedef struct plr_extent_gate {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view record;     /* r x 1 x N */
  plr_const_view predicted;  /* d x 1 x N: predicted position */
  plr_const_view covariance; /* d x d x N: H P H' */
  plr_extent_points scan;
  plr_view squared_distance; /* 1 x 1 x total: chi-square with d degrees of freedom for a point of this object */
} plr_extent_gate;

typedef struct plr_extent {
  plr_table_head head;
  /* [worker, concurrent] Constant while the instance lives. */
  const plr_extent_info* (*info)(const void* self);
  /* [worker, concurrent] [hot] NULL for an instance that is joint (as predict, effective_noise, update, gate). */
  plr_status (*init)(const void* self, const plr_call* call, const plr_extent_init* args);
  /* [worker, concurrent] [hot] */
  plr_status (*predict)(const void* self, const plr_call* call, const plr_extent_predict* args);
  /* [worker, concurrent] [hot] */
  plr_status (*effective_noise)(const void* self, const plr_call* call, const plr_extent_effective_noise* args);
  /* [worker, concurrent] [hot] */
  plr_status (*update)(const void* self, const plr_call* call, const plr_extent_update* args);
  /* [worker, concurrent] [hot] Also of a joint record. */
  plr_status (*shape)(const void* self, const plr_call* call, const plr_extent_shape* args);
  /* [worker, concurrent] [hot] */
  plr_status (*gate)(const void* self, const plr_call* call, const plr_extent_gate* args);
} plr_extent;

/* Extension of the instance: kinematics and shape in one record (slots `motion` and, where it needs one, `sensors`). */
#define PLR_EXTENT_JOINT "pelorus.extent.joint/1"

typedef struct plr_joint_init {
  uint32_t struct_size;
  uint32_t scans;
  const plr_extent_points* scan; /* [scans] as plr_extent_init */
  plr_const_view times;          /* scans x 1 x 1, s */
  plr_const_view mean;           /* c x 1 x N: kinematics at the time of the last scan given */
  plr_const_view covariance; /* c x c x N, or data NULL: the instance takes its own from the scans (start_scans 2) */
  plr_view record;           /* r x 1 x N */
} plr_joint_init;

typedef struct plr_joint_predict {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view dt;     /* 1 x 1 x N, s */
  plr_const_view record; /* r x 1 x N */
  plr_view out;          /* r x 1 x N; may be `record` itself */
} plr_joint_predict;

typedef struct plr_joint_update {
  uint32_t struct_size;
  uint32_t reserved;
  plr_extent_points scan;
  plr_const_view record;          /* r x 1 x N; predicted */
  plr_view out;                   /* r x 1 x N; may be `record` itself. An item without points is copied */
  plr_view log_likelihood;        /* 1 x 1 x N, or data NULL */
  plr_view innovation;            /* d x 1 x N: centroid - predicted, or data NULL */
  plr_view innovation_covariance; /* d x d x N, or data NULL */
} plr_joint_update;

typedef struct plr_joint_summary {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view record; /* r x 1 x N */
  plr_view mean;         /* c x 1 x N */
  plr_view covariance;   /* c x c x N, or data NULL */
} plr_joint_summary;

typedef struct plr_extent_joint {
  uint32_t struct_size;
  uint32_t sensor_count;
  const plr_part* sensors;    /* [sensor_count], as in plr_estimator_info: for noise, residual and invert */
  const plr_space* cartesian; /* c */
  /* [worker, concurrent] [hot] */
  plr_status (*init)(const void* self, const plr_call* call, const plr_joint_init* args);
  /* [worker, concurrent] [hot] */
  plr_status (*predict)(const void* self, const plr_call* call, const plr_joint_predict* args);
  /* [worker, concurrent] [hot] */
  plr_status (*update)(const void* self, const plr_call* call, const plr_joint_update* args);
  /* [worker, concurrent] [hot] */
  plr_status (*summary)(const void* self, const plr_call* call, const plr_joint_summary* args);
  /* [worker, concurrent] [hot] As plr_extent.gate; predicted and covariance come from the record. */
  plr_status (*gate)(const void* self, const plr_call* call, const plr_extent_gate* args);
} plr_extent_joint;

#endif
