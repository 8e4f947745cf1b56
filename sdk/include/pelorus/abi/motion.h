/* Pelorus ABI: motion: a state space and how it evolves.
 *
 * Letters: n state components, c Cartesian components, r doubles of record, p points an item, N items.
 * A motion's record is what its noise must remember besides the state (the last posterior variance of an adaptive model).
 * The order of a step, kept by every estimator:
 *
 *     start    init_record(mean, covariance)
 *     predict  propagate / jacobian / noise, all with the record as it stands and the posterior that the step starts from;
 *              then advance_record with that same posterior: the record now remembers it
 *     update   does not touch the record
 */
#ifndef PELORUS_ABI_MOTION_H
#define PELORUS_ABI_MOTION_H

#include "plugin.h"

#define PLR_MOTION "pelorus.motion/1"

enum {
  PLR_MOTION_TIME_INVARIANT = 1u << 16, /* F(a + b) = F(b) F(a) */
  PLR_MOTION_EXACT_NOISE = 1u << 17,    /* Q(a + b) = F(b) Q(a) F(b)' + Q(b) */
  PLR_MOTION_LINEAR = 1u << 18,         /* propagate is F x (not F x + b), F a function of dt and inputs alone */
  PLR_MOTION_CONSTANT_NOISE = 1u << 19, /* Q is a function of dt and inputs alone */
  PLR_MOTION_BACKWARD = 1u << 20,       /* dt < 0 is answered (retrodiction, smoothing); else PLR_E_UNSUPPORTED */
  PLR_MOTION_USES_EXTENT = 1u << 21     /* noise needs args.extent */
};

typedef struct plr_motion_info {
  uint32_t struct_size;
  uint32_t flags;
  const plr_space* state;     /* n components */
  const plr_space* cartesian; /* c components, position first; equal to state where the state is Cartesian */
  int64_t record_size;        /* r, may be 0 */
  uint32_t record_version;    /* of the layout of the record; see record.h */
  uint32_t reserved;
  uint64_t scratch_bytes; /* for any N (work in blocks), the largest need of its parts included */
} plr_motion_info;

typedef struct plr_motion_propagate {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view dt;    /* 1 x 1 x N, s; item_stride 0: one for all */
  plr_const_view state; /* n x p x N */
  plr_const_view
      mean; /* n x 1 x N: posterior mean that the points are spread about; data NULL: p = 1, and the state is it */
  plr_const_view record; /* r x 1 x N */
  plr_view out;          /* n x p x N; the mean motion, without noise */
} plr_motion_propagate;

typedef struct plr_motion_jacobian {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view dt;     /* 1 x 1 x N, s */
  plr_const_view state;  /* n x 1 x N, before the step */
  plr_const_view mean;   /* n x 1 x N, as in plr_motion_propagate */
  plr_const_view record; /* r x 1 x N */
  plr_view out;          /* n x n x N, d propagate / d state, `mean` held fixed */
} plr_motion_jacobian;

typedef struct plr_motion_noise {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view dt;         /* 1 x 1 x N, s */
  plr_const_view state;      /* n x 1 x N, posterior mean before the step */
  plr_const_view covariance; /* n x n x N, posterior covariance before the step; data NULL only with CONSTANT_NOISE */
  plr_const_view predicted;  /* n x 1 x N, mean after the step; data NULL only with CONSTANT_NOISE */
  plr_const_view extent;     /* d x d x N, m^2, with USES_EXTENT; else data NULL */
  plr_const_view record;     /* r x 1 x N */
  plr_view out;              /* n x n x N, symmetric positive semidefinite */
} plr_motion_noise;

typedef struct plr_motion_record {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view dt;         /* 1 x 1 x N, s; init_record: data NULL */
  plr_const_view state;      /* n x 1 x N */
  plr_const_view covariance; /* n x n x N */
  plr_const_view record;     /* r x 1 x N; init_record: data NULL */
  plr_view out;              /* r x 1 x N; may be `record` itself */
} plr_motion_record;

/* State to Cartesian components or back. The two are inverse to each other. Components that are not kinematic (a turn rate)
 * stand in both spaces and pass through. */
typedef struct plr_motion_convert {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view in; /* n x p x N (to_cartesian) or c x p x N (from_cartesian) */
  plr_view out;      /* c x p x N or n x p x N */
  plr_view jacobian; /* d out / d in at the item's only point (p = 1), or data NULL */
} plr_motion_convert;

typedef struct plr_motion {
  plr_table_head head;
  /* [worker, concurrent] Constant while the instance lives. */
  const plr_motion_info* (*info)(const void* self);
  /* [worker, concurrent] [hot] */
  plr_status (*propagate)(const void* self, const plr_call* call, const plr_motion_propagate* args);
  /* [worker, concurrent] [hot] */
  plr_status (*jacobian)(const void* self, const plr_call* call, const plr_motion_jacobian* args);
  /* [worker, concurrent] [hot] */
  plr_status (*noise)(const void* self, const plr_call* call, const plr_motion_noise* args);
  /* [worker, concurrent] [hot] NULL where record_size is 0. */
  plr_status (*init_record)(const void* self, const plr_call* call, const plr_motion_record* args);
  /* [worker, concurrent] [hot] NULL where record_size is 0. */
  plr_status (*advance_record)(const void* self, const plr_call* call, const plr_motion_record* args);
  /* [worker, concurrent] [hot] NULL where the state is Cartesian. */
  plr_status (*to_cartesian)(const void* self, const plr_call* call, const plr_motion_convert* args);
  /* [worker, concurrent] [hot] NULL where the state is Cartesian. Components that the state lacks are ignored. */
  plr_status (*from_cartesian)(const void* self, const plr_call* call, const plr_motion_convert* args);
} plr_motion;

/* Extension: F = F1 (x) I_d and Q = Q1 (x) I_d, where the state is ordered by derivative (positions, velocities, ...), so
 * that one small F1 and Q1 of a dt serve every track. Only for LINEAR motions with CONSTANT_NOISE whose F and Q read no input. */
#define PLR_MOTION_STRUCTURE "pelorus.motion.structure/1"

typedef struct plr_motion_structure {
  uint32_t struct_size;
  int32_t block;     /* b: rows of F1 */
  int32_t dimension; /* d: axes; n = b d */
  uint32_t reserved;
  /* [worker, concurrent] [hot] F1 and Q1, b x b column-major, for one dt (s). */
  plr_status (*blocks)(const void* self, const plr_call* call, double dt, double* f1, double* q1);
} plr_motion_structure;

/* Extension: a factor of the noise, Q = G G', for square-root filters whose Q is singular (rank g < n). */
#define PLR_MOTION_NOISE_FACTOR "pelorus.motion.noise_factor/1"

typedef struct plr_motion_noise_factor {
  uint32_t struct_size;
  int32_t columns; /* g */
  /* [worker, concurrent] [hot] As noise, with out n x g x N. */
  plr_status (*factor)(const void* self, const plr_call* call, const plr_motion_noise* args);
} plr_motion_noise_factor;

#endif
