/* Pelorus ABI: spaces: what the components of a vector mean.
 *
 * Names are dotted: `position.x`, `velocity.y`, `acceleration.z`, `range`, `range_rate`, `azimuth`, `elevation`,
 * `zenith`. Units are SI (`m`, `m/s`, `rad`). Canonical order: positions, velocities, accelerations; measurements
 * range, [range rate,] azimuth, elevation or zenith; azimuth from +x to +y, in (-pi, pi]. velocity.x is the rate of position.x.
 * Two spaces are the same when names, units and order are. States of different models meet by component name.
 *
 * Element structs (here and in describe.h) begin with struct_size and may grow at the tail: a reader steps through an
 * array by the struct_size of its first element, never by its own sizeof.
 */
#ifndef PELORUS_ABI_SPACE_H
#define PELORUS_ABI_SPACE_H

#include "threads.h"

enum {
  PLR_COMPONENT_ANGLE = 1u << 0 /* differences wrap to (-pi, pi] */
};

typedef struct plr_component {
  uint32_t struct_size;
  uint32_t flags;
  const char* name;
  const char* unit;
  double prior_mean;      /* what the component is taken to be where nothing is known of it */
  double prior_deviation; /* and how well; > 0. Measurement components: 0 */
} plr_component;

typedef struct plr_space {
  uint32_t struct_size;
  uint32_t size;
  const plr_component* components; /* [size] */
} plr_space;

#endif
