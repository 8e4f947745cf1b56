/// The `frames:` block of a config.
///
///     frames:
///       site:  {origin: [43.1 deg, 5.9 deg, 12 m]}          latitude, longitude, height on WGS84: a local east-north-up frame
///       mast:  {parent: site, translation: [0 m, 0 m, 20 m], attitude: [0 deg, 0 deg, 30 deg]}
///       other: {quaternion: [1, 0, 0, 0]}                   w, x, y, z; no parent: the root frame
///
/// A point p of a frame is C p + translation in its parent; attitude is roll, pitch, yaw with C = Rz(yaw) Ry(pitch) Rx(roll).
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "graph/problems.hpp"
#include "graph/value.hpp"
#include "host/services.hpp"

namespace pelorus::graph {

/// Adds the frames that `block` names (nullptr: none) to the tree, parents first, and answers the block in SI.
nlohmann::ordered_json read_frames(const Value* block, host::FrameTree& tree, Problems& problems);

}  // namespace pelorus::graph
