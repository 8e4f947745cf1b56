/* Pelorus ABI: frames of reference, as the config's `frames:` names them.
 * A frame has a parent and stands to it by p_parent = C p + t (C from a unit quaternion), or it is a local
 * east-north-up frame at a geodetic origin on WGS84 (its parent is Earth-centred, Earth-fixed). */
#ifndef PELORUS_ABI_FRAMES_H
#define PELORUS_ABI_FRAMES_H

#include "status.h"

#define PLR_SERVICE_FRAMES "pelorus.frames/1"

/* Where one frame stands to another: p_to = rotation p_from + translation. The caller sets struct_size. */
typedef struct plr_frame_pose {
  uint32_t struct_size;
  uint32_t reserved;
  double rotation[9];    /* 3 x 3, column-major */
  double translation[3]; /* m */
} plr_frame_pose;

typedef struct plr_frames {
  uint32_t struct_size;
  uint32_t reserved;
  void* context;
  /* [any] How frame `from` stands to frame `to` at a time (ns). PLR_E_DATA: no such frame, or not joined.
   * Rationale: the frames of a config stand still. The time is asked for all the same, so that a frame that moves needs no
   * other service; its rates would stand at the end of plr_frame_pose. */
  plr_status (*transform)(void* context, const char* from, const char* to, int64_t time, plr_frame_pose* out,
                          plr_error* error);
  /* [any] Geodetic (rad, rad, m above the WGS84 ellipsoid) to Cartesian coordinates of the frame (m), and back. */
  plr_status (*from_geodetic)(void* context, const char* frame, const double geodetic[3], double cartesian[3],
                              plr_error* error);
  plr_status (*to_geodetic)(void* context, const char* frame, const double cartesian[3], double geodetic[3],
                            plr_error* error);
} plr_frames;

#endif
