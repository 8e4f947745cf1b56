/// How what is known of a group's shape fades: the certainty l = v - 2d - 2 of an inverse-Wishart extent from one time to another.
/// Source: W. Koch, J. Lan, X. R. Li (see README.md); M. Feldmann, D. Fraenken, W. Koch, IEEE Transactions on Signal Processing
/// 59(4), 2011, for the match of moments.
#pragma once

#include <cmath>

namespace group_random_matrix {

/// Below this certainty the printed law gives less than nothing, and the other one would make a shape better known with time.
constexpr double least_certainty = 2;

/// l' = l (delta + 2)/(l + delta) for a step: the mean of the shape stays, and its second moment becomes that of a Wishart variable of
/// `degrees` degrees about it. In 1/l - 1/2 that is a factor delta/(delta + 2), so that any number of steps is a power of it:
/// a long step is many short ones, and l comes to 2 from above in the end.
inline double evolved_by_moments(double certainty, double degrees, double steps) {
    const double kept = std::pow(degrees / (degrees + 2), steps);
    return 1 / (0.5 + (1 / certainty - 0.5) * kept);
}

/// l' = 2 + 2 delta (l + 1)(l - 1)(l - 2)/(l^2 (l + delta)), as Han and Zhou print it: for a step, however long it is.
inline double evolved_as_printed(double certainty, double degrees) {
    const double l = certainty;
    return 2 + 2 * degrees * (l + 1) * (l - 1) * (l - 2) / (l * l * (l + degrees));
}

}  // namespace group_random_matrix
