/* Pelorus ABI: random numbers.
 *
 * Philox-4x32-10 (Salmon, Moraes, Dror, Shaw: Parallel Random Numbers: As Easy as 1, 2, 3; SC 2011). A key names a
 * stream of numbers; number j of a key is a pure function of (key, j). Nothing is drawn "next": order of items, number
 * of threads and interruptions do not matter.
 *
 * Keys are made from (seed, run, node) by the host and refined by derive() with (stream, step, item id). Noise,
 * detection, clutter and start are separate streams, so that switching one off leaves the others as they were.
 * A holder gives a model one key an item and step; the model derives one key an operation and one a part from it.
 */
#ifndef PELORUS_ABI_RANDOM_H
#define PELORUS_ABI_RANDOM_H

#include "threads.h"

#define PLR_SERVICE_RANDOM "pelorus.random/1"

typedef struct plr_key {
  uint64_t word[2];
} plr_key;

/* Streams that Pelorus itself uses; a plugin takes its own from 1000 on. */
enum {
  PLR_STREAM_NOISE = 1,
  PLR_STREAM_DETECTION = 2,
  PLR_STREAM_CLUTTER = 3,
  PLR_STREAM_START = 4,
  PLR_STREAM_EXTENT = 5,
  PLR_STREAM_TRAJECTORY = 6,
  PLR_STREAM_PARTICLES = 7
};

typedef struct plr_random {
  uint32_t struct_size;
  uint32_t reserved;
  /* [any] [hot] A new key, statistically independent of its parent and of all its siblings. */
  plr_key (*derive)(plr_key parent, uint64_t stream, uint64_t step, uint64_t item);
  /* [any] [hot] Numbers first .. first + count - 1 of the key, uniform in the open interval (0, 1). */
  void (*uniform)(plr_key key, uint64_t first, int64_t count, double* out);
  /* [any] [hot] The same, standard normal (Box-Muller on uniform numbers 2j and 2j + 1 gives normals 2j and 2j + 1). */
  void (*normal)(plr_key key, uint64_t first, int64_t count, double* out);
} plr_random;

#endif
