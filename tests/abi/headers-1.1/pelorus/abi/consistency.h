/* Pelorus ABI: consistency: whether errors are as large as covariances say. What trackers tell for it, and how bounds of many runs
 * come about.
 *
 * Both sides meet by name only: a tracker that tells no innovations works, an analyzer that gets none leaves their table out.
 */
#ifndef PELORUS_ABI_CONSISTENCY_H
#define PELORUS_ABI_CONSISTENCY_H

#include "message.h"

#define PLR_CONSISTENCY "pelorus.consistency/1"

/* The name of a plr_quantity (address "", unit "") in a `values` message: normalised innovations squared. Its `numbers` are
 * 2 x 1 x N, one item for each of `ids`: d^2 = e' S^-1 e of the measurement that the track was updated with, e and S as predicted
 * before it; and how many components e has. Valid at the time of the scan alone (valid_from = valid_to). Only of measurements that a
 * prediction was there for: not of those that a track began with. */
#define PLR_QUANTITY_INNOVATION "normalised_innovation_squared"

enum {
  /* A reduction of a column or scalar beside those of message.h: a bound of a mean of normalised squares. Each run tells how
   * many degrees of freedom its squares have; of D, the sum of the finite ones, comes the quantile (plr_column.quantile, 0 to 1,
   * both excluded) of chi-square with D degrees of freedom, divided by D. So a mean that is 1 where all is right has bounds at,
   * say, 0.025 and 0.975, whatever the number of runs. */
  PLR_REDUCE_CHI_SQUARE = 9
};

#endif
