/* Pelorus ABI: estimator: a filter. Its parts are motions (or estimators) and sensors; its state is a record.
 *
 * Letters: n native state components, c Cartesian components of the summary, m measurement components of the sensor in
 * question, r doubles of record, N items (tracks).
 * The record holds everything: moments, square roots, particles, the motions' records, nested estimators' records. Only its
 * size and version are the caller's business.
 *
 * A step: predict (once a time), then project and update for each measurement used at that time. dt = 0 copies the record;
 * motions are not called then. Sensors are named in the
 * config and numbered in info.sensors; a scan meets its sensor by name.
 */
#ifndef PELORUS_ABI_ESTIMATOR_H
#define PELORUS_ABI_ESTIMATOR_H

#include "sensor.h"

#define PLR_ESTIMATOR "pelorus.estimator/1"

enum {
  PLR_ESTIMATOR_BACKWARD = 1u << 16,    /* predict answers dt < 0 */
  PLR_ESTIMATOR_USES_EXTENT = 1u << 17, /* predict needs args.extent */
  PLR_ESTIMATOR_ASSIGNABLE = 1u << 18,  /* assign is answered (it is not by a particle filter) */
  /* Takes measurements late: after predict with dt < 0, back to a time that the record still knows (else that item fails
   * with PLR_E_NUMERIC), update takes a measurement of that time, and a predict forward to the newest time answers what
   * in-sequence processing would have. Moments in between are those of the time gone back to, measurements up to it used. */
  PLR_ESTIMATOR_OUT_OF_SEQUENCE = 1u << 19
};

typedef struct plr_estimator_info {
  uint32_t struct_size;
  uint32_t flags;
  const plr_space* state;     /* n; what moments and assign speak */
  const plr_space* cartesian; /* c; what init and summary speak: position first, 1 to 3 of them */
  int64_t record_size;
  uint32_t record_version; /* its own and those of its parts' records; see record.h */
  uint32_t sensor_count;
  const plr_part* sensors; /* [sensor_count]; instances to be called directly for noise, residual and invert */
  uint64_t scratch_bytes;  /* for any N (work in blocks), the largest need of its parts included */
} plr_estimator_info;

typedef struct plr_estimator_init {
  uint32_t struct_size;
  uint32_t known; /* k: how many components are given */
  const int32_t*
      components;      /* [k] their indices in info.cartesian, ascending; the others enter with their declared prior
                                mean and deviation, uncorrelated */
  plr_const_view mean; /* k x 1 x N */
  plr_const_view covariance; /* k x k x N */
  plr_view record;           /* r x 1 x N */
} plr_estimator_init;

typedef struct plr_estimator_predict {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view dt;     /* 1 x 1 x N, s */
  plr_const_view extent; /* d x d x N, m^2: the shape that the step starts from, or data NULL */
  plr_const_view record; /* r x 1 x N */
  plr_view out;          /* r x 1 x N; may be `record` itself */
} plr_estimator_predict;

typedef struct plr_estimator_project {
  uint32_t struct_size;
  int32_t sensor;           /* index into info.sensors */
  plr_const_view record;    /* r x 1 x N */
  plr_view measurement;     /* m x 1 x N: predicted measurement */
  plr_view covariance;      /* m x m x N: H P H', without R */
  plr_view cross;           /* n x m x N: P H' in the native state, or data NULL */
  plr_view cartesian_cross; /* c x m x N: the same in Cartesian components, or data NULL */
} plr_estimator_project;

typedef struct plr_estimator_update {
  uint32_t struct_size;
  int32_t sensor;
  plr_const_view record;      /* r x 1 x N */
  plr_const_view measurement; /* m x 1 x N: one an item */
  plr_const_view noise;       /* m x m x N: R, with the extent's share where there is one */
  plr_view out;               /* r x 1 x N; may be `record` itself */
  plr_view
      log_likelihood; /* 1 x 1 x N: ln p(measurement | past); for a Gaussian filter ln N(innovation; 0, S); or data NULL */
  plr_view innovation;            /* m x 1 x N, or data NULL */
  plr_view innovation_covariance; /* m x m x N: S = H P H' + R, or data NULL */
} plr_estimator_update;

/* Mean and covariance of a record (moments, summary), or a record with new ones (assign). */
typedef struct plr_estimator_moments {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view record; /* r x 1 x N */
  plr_view mean;         /* n x 1 x N, or c x 1 x N for summary */
  plr_view covariance;   /* n x n x N, or c x c x N; data NULL: not wanted */
} plr_estimator_moments;

typedef struct plr_estimator_assign {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view record;     /* r x 1 x N: what is not moments (the motions' records) is taken from here */
  plr_const_view mean;       /* n x 1 x N */
  plr_const_view covariance; /* n x n x N */
  plr_view out;              /* r x 1 x N; may be `record` itself */
} plr_estimator_assign;

typedef struct plr_estimator {
  plr_table_head head;
  /* [worker, concurrent] Constant while the instance lives. */
  const plr_estimator_info* (*info)(const void* self);
  /* [worker, concurrent] [hot] */
  plr_status (*init)(const void* self, const plr_call* call, const plr_estimator_init* args);
  /* [worker, concurrent] [hot] */
  plr_status (*predict)(const void* self, const plr_call* call, const plr_estimator_predict* args);
  /* [worker, concurrent] [hot] */
  plr_status (*project)(const void* self, const plr_call* call, const plr_estimator_project* args);
  /* [worker, concurrent] [hot] */
  plr_status (*update)(const void* self, const plr_call* call, const plr_estimator_update* args);
  /* [worker, concurrent] [hot] In Cartesian components. */
  plr_status (*summary)(const void* self, const plr_call* call, const plr_estimator_moments* args);
  /* [worker, concurrent] [hot] In native components. */
  plr_status (*moments)(const void* self, const plr_call* call, const plr_estimator_moments* args);
  /* [worker, concurrent] [hot] NULL without ASSIGNABLE. An IMM mixes through moments and assign, by component name. */
  plr_status (*assign)(const void* self, const plr_call* call, const plr_estimator_assign* args);
} plr_estimator;

/* Extension: one record from several hypotheses about the same item (PDA, JPDA, Gaussian mixtures). */
#define PLR_ESTIMATOR_MIX "pelorus.estimator.mix/1"

typedef struct plr_estimator_mix_args {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view weights; /* k x 1 x N, >= 0, sum 1 */
  plr_const_view records; /* r x k x N */
  plr_view out;           /* r x 1 x N: moments matched */
} plr_estimator_mix_args;

typedef struct plr_estimator_mix {
  uint32_t struct_size;
  uint32_t reserved;
  /* [worker, concurrent] [hot] */
  plr_status (*mix)(const void* self, const plr_call* call, const plr_estimator_mix_args* args);
} plr_estimator_mix;

/* Extension: the modes of a multiple-model filter. */
#define PLR_ESTIMATOR_MODES "pelorus.estimator.modes/1"

typedef struct plr_estimator_modes {
  uint32_t struct_size;
  int32_t mode_count;
  const char* const* names; /* [mode_count] */
  /* [worker, concurrent] [hot] record r x 1 x N -> probabilities mode_count x 1 x N. */
  plr_status (*probabilities)(const void* self, const plr_call* call, const plr_const_view* record,
                              const plr_view* out);
} plr_estimator_modes;

/* Extension: estimates of times past, improved by what has been measured since (a fixed-lag smoother). */
#define PLR_ESTIMATOR_SMOOTHED "pelorus.estimator.smoothed/1"

typedef struct plr_estimator_smoothed_args {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view record; /* r x 1 x N */
  plr_view known;        /* 1 x 1 x N: k, how many times the record tells of, 1 to `most` */
  plr_view age;        /* most x 1 x N, s: how long before the record's time, ascending; the first is 0. From k on 0 */
  plr_view mean;       /* c x most x N: Cartesian; the first is that of summary. From k on 0 */
  plr_view covariance; /* c x (c most) x N, side by side, or data NULL. From k on 0 */
} plr_estimator_smoothed_args;

typedef struct plr_estimator_smoothed {
  uint32_t struct_size;
  int32_t most; /* times that a record tells of at most, the newest included */
  /* [worker, concurrent] [hot] */
  plr_status (*smoothed)(const void* self, const plr_call* call, const plr_estimator_smoothed_args* args);
} plr_estimator_smoothed;

#endif
