/// The space of motions that stand side by side, each over components of its own.
#pragma once

#include <string>
#include <vector>

#include <pelorus/parts.hpp>
#include <pelorus/space.hpp>

namespace composite {

/// Which axes of the whole the axes x, y, z of a part are; empty: its own.
struct Member {
    pelorus::MotionPart motion;
    std::string axes;          ///< "z", "xy", ...
    std::vector<int> places;   ///< where its components stand in the whole; set by join
    std::int64_t record = 0;   ///< where its record stands in the whole's
    std::int64_t columns = 0;  ///< of its noise factor, where it offers one
};

/// The members' components under their names in the whole, in canonical order: positions, velocities, accelerations, jerks, each
/// over x, y, z, then all others in the members' order. Fills `places`. Throws PartError where a component stands twice, an axis
/// is not one of a part's, or the positions do not begin with x and leave none out.
pelorus::Space join(std::vector<Member>& members);

}  // namespace composite
