/* Pelorus ABI: sensor: a measurement space, its geometry and its noise.
 *
 * Letters: m measurement components, c Cartesian components that the sensor looks at, w waveform parameters, p points an
 * item, N items. The Cartesian components are in the frame of the stage that holds the sensor; the sensor's own mount
 * (position, attitude, velocity) is its parameters or, where it moves, its inputs.
 */
#ifndef PELORUS_ABI_SENSOR_H
#define PELORUS_ABI_SENSOR_H

#include "plugin.h"

#define PLR_SENSOR "pelorus.sensor/1"

enum {
  PLR_SENSOR_LINEAR = 1u << 16,         /* measure is H x + constant */
  PLR_SENSOR_CONSTANT_NOISE = 1u << 17, /* noise depends on no argument */
  PLR_SENSOR_CAN_INVERT = 1u << 18,     /* a single measurement determines all components of `inverse` */
  PLR_SENSOR_WAVEFORM = 1u << 19        /* noise depends on the waveform in force */
};

typedef struct plr_sensor_info {
  uint32_t struct_size;
  uint32_t flags;
  const plr_space* measurement; /* m */
  const plr_space* cartesian;   /* c: what measure reads */
  const plr_space* inverse;     /* what invert answers, a subset of `cartesian` in its order; NULL without CAN_INVERT */
  const plr_space* waveform;    /* w: parameters of a waveform, or NULL */
  uint64_t scratch_bytes;       /* for any N (work in blocks), the largest need of its parts included */
} plr_sensor_info;

typedef struct plr_sensor_measure {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view cartesian; /* c x p x N */
  plr_view out;             /* m x p x N; without noise */
} plr_sensor_measure;

typedef struct plr_sensor_jacobian {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view cartesian; /* c x 1 x N */
  plr_view out;             /* m x c x N */
} plr_sensor_jacobian;

typedef struct plr_sensor_noise {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view cartesian; /* c x 1 x N: where the object is or is predicted; data NULL only with CONSTANT_NOISE */
  plr_const_view snr;       /* 1 x 1 x N, power ratio; data NULL: the sensor's nominal one */
  plr_const_view waveform;  /* w x 1 x N; data NULL: the sensor's base waveform */
  plr_view out;             /* m x m x N */
} plr_sensor_noise;

typedef struct plr_sensor_residual {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view measurement; /* m x p x N */
  plr_const_view reference;   /* m x 1 x N or m x p x N */
  plr_view out;               /* m x p x N: measurement - reference, angles wrapped to (-pi, pi] */
} plr_sensor_residual;

typedef struct plr_sensor_invert {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view measurement; /* m x 1 x N */
  plr_const_view noise;       /* m x m x N */
  plr_view mean;              /* i x 1 x N, unbiased */
  plr_view covariance;        /* i x i x N, consistent, or data NULL */
} plr_sensor_invert;

typedef struct plr_sensor {
  plr_table_head head;
  /* [worker, concurrent] Constant while the instance lives. */
  const plr_sensor_info* (*info)(const void* self);
  /* [worker, concurrent] [hot] */
  plr_status (*measure)(const void* self, const plr_call* call, const plr_sensor_measure* args);
  /* [worker, concurrent] [hot] */
  plr_status (*jacobian)(const void* self, const plr_call* call, const plr_sensor_jacobian* args);
  /* [worker, concurrent] [hot] */
  plr_status (*noise)(const void* self, const plr_call* call, const plr_sensor_noise* args);
  /* [worker, concurrent] [hot] */
  plr_status (*residual)(const void* self, const plr_call* call, const plr_sensor_residual* args);
  /* [worker, concurrent] [hot] NULL without CAN_INVERT. */
  plr_status (*invert)(const void* self, const plr_call* call, const plr_sensor_invert* args);
} plr_sensor;

#endif
