/* Pelorus ABI: frames of reference, as the config's `frames:` names them.
 * A frame has a parent and stands to it by p_parent = C p + t (C from a unit quaternion), or it is a local
 * east-north-up frame at a geodetic origin on WGS84 (its parent is Earth-centred, Earth-fixed). */
#ifndef PELORUS_ABI_FRAMES_H
#define PELORUS_ABI_FRAMES_H

#include "status.h"

#define PLR_SERVICE_FRAMES "pelorus.frames.draft/1"

typedef struct plr_frames {
  uint32_t struct_size;
  uint32_t reserved;
  void* context;
  /* [any] p_to = rotation p_from + translation (m); rotation is 3 x 3 column-major. PLR_E_DATA: no such frame, or not joined. */
  plr_status (*transform)(void* context, const char* from, const char* to, double rotation[9], double translation[3],
                          plr_error* error);
  /* [any] Geodetic (rad, rad, m above the WGS84 ellipsoid) to Cartesian coordinates of the frame (m), and back. */
  plr_status (*from_geodetic)(void* context, const char* frame, const double geodetic[3], double cartesian[3],
                              plr_error* error);
  plr_status (*to_geodetic)(void* context, const char* frame, const double cartesian[3], double geodetic[3],
                            plr_error* error);
} plr_frames;

#endif
