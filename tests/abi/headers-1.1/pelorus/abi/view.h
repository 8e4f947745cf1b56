/* Pelorus ABI: arrays.
 *
 * A view is a batch of `count` matrices, rows x cols each, in memory that the caller owns:
 *
 *     element (row, col) of item i = data[i * item_stride + col * col_stride + row * row_stride]
 *
 * Strides count doubles. Matrices are column-major and packed: row_stride 1, col_stride rows. item_stride is free (records
 * nest in records); 0 means one matrix common to all items (inputs only; count is N all the same). Vectors are rows x 1; where a call says so, the
 * columns of an item are several points of one object (sigma points, measurements), so that one call moves them all.
 *
 * Other row and column strides (structure of arrays: row_stride = count) come only to instances whose info flags hold
 * PLR_FLAG_ANY_STRIDE. data NULL means: not given (only where a call says that an array is optional).
 * Outputs never overlap inputs, except where a call allows `out == in` exactly.
 *
 * Rationale: Eigen and std:: types across this boundary crash (another -march lays them out and aligns them otherwise);
 * a pointer with strides can be wrapped by Eigen::Map, NumPy or Fortran at no cost.
 */
#ifndef PELORUS_ABI_VIEW_H
#define PELORUS_ABI_VIEW_H

#include "threads.h"

typedef struct plr_view {
  double* data;
  int64_t rows, cols, count;
  int64_t row_stride, col_stride, item_stride;
} plr_view;

typedef struct plr_const_view {
  const double* data;
  int64_t rows, cols, count;
  int64_t row_stride, col_stride, item_stride;
} plr_const_view;

/* Flags of a model instance (plr_*_info.flags), common to all kinds. Each kind adds its own from bit 16 on. */
enum {
  PLR_FLAG_ANY_STRIDE = 1u << 0, /* hot calls accept any strides at full speed */
  PLR_FLAG_USES_KEYS = 1u << 1   /* draws random numbers: call.keys must be given */
};

#endif
