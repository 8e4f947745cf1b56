/* Pelorus ABI: waveform: picks a sensor's next waveform, and says what measurement noise a waveform implies.
 *
 * Letters: m measurement components, c Cartesian components, w waveform parameters, h steps of horizon, N items (looks).
 * A scheduler calls choose and sends the answer to the sensor as a command; the sensor that holds the same model in its slot
 * `waveform` calls noise with the parameters in force. So both sides take the noise from one place.
 */
#ifndef PELORUS_ABI_WAVEFORM_H
#define PELORUS_ABI_WAVEFORM_H

#include "plugin.h"

#define PLR_WAVEFORM "pelorus.waveform/1"

typedef struct plr_waveform_info {
  uint32_t struct_size;
  uint32_t flags;
  const plr_space* measurement; /* m: what it knows how to shape */
  const plr_space* waveform;    /* w: names, units; prior_mean is the base waveform */
  int32_t horizon;              /* h: predicted steps that choose reads; 1 for a myopic rule. Moments of later steps are
                                   predictions without updates; a rule that needs the transition holds a motion in a slot */
  uint32_t reserved;
  uint64_t scratch_bytes; /* for any N (work in blocks), the largest need of its parts included */
} plr_waveform_info;

typedef struct plr_waveform_choose {
  uint32_t struct_size;
  uint32_t reserved;
  const plr_space* cartesian; /* the c components */
  plr_const_view dt;          /* h x 1 x N, s: from each step to the next */
  plr_const_view mean;        /* c x h x N: predicted Cartesian means, step 1 .. h */
  plr_const_view covariance;  /* c x (c h) x N: their covariances side by side */
  plr_const_view projected;   /* m x (m h) x N: H P H' side by side, without R */
  plr_const_view cross;       /* c x (m h) x N: P H' side by side */
  plr_const_view base_noise;  /* m x m x N: the sensor's noise with its base waveform */
  plr_view waveform;          /* w x 1 x N */
  plr_view noise;             /* m x m x N: what it implies */
  plr_view criterion;         /* 1 x 1 x N: the value it was chosen by, smaller is better, or data NULL */
} plr_waveform_choose;

typedef struct plr_waveform_noise {
  uint32_t struct_size;
  uint32_t reserved;
  plr_const_view waveform;   /* w x 1 x N */
  plr_const_view base_noise; /* m x m x N */
  plr_view out;              /* m x m x N */
} plr_waveform_noise;

typedef struct plr_waveform {
  plr_table_head head;
  /* [worker, concurrent] Constant while the instance lives. */
  const plr_waveform_info* (*info)(const void* self);
  /* [worker, concurrent] [hot] */
  plr_status (*choose)(const void* self, const plr_call* call, const plr_waveform_choose* args);
  /* [worker, concurrent] [hot] */
  plr_status (*noise)(const void* self, const plr_call* call, const plr_waveform_noise* args);
} plr_waveform;

#endif
