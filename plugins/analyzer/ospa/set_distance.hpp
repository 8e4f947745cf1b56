/// How far apart two sets of points are: OSPA and GOSPA from one optimal assignment.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace ospa {

/// A position (m); components that a plane lacks are 0.
using Point = std::array<double, 3>;

/// What a distance is made from. In both, the order-th powers of the parts add up to that of the whole.
struct SetDistance {
    double ospa = 0, ospa_localisation = 0, ospa_cardinality = 0;                 ///< m
    double gospa = 0, gospa_localisation = 0, gospa_missed = 0, gospa_false = 0;  ///< m
    std::int64_t missed = 0;      ///< objects without an estimate within the cutoff
    std::int64_t false_ones = 0;  ///< estimates without an object within the cutoff
};

/// OSPA of order p and cutoff c, with n the size of the larger set and m that of the smaller one:
///     (1/n (min over assignments of sum min(d, c)^p + c^p (n - m)))^(1/p),
/// and GOSPA with alpha = 2, where every object missed and every false estimate costs c^p / 2. A pair that is c or more apart
/// costs c^p either way, so that one assignment is the best for both. Both are 0 between two empty sets.
/// cutoff > 0 (m), order >= 1.
SetDistance set_distance(const std::vector<Point>& objects, const std::vector<Point>& estimates, double cutoff,
                         double order);

}  // namespace ospa
