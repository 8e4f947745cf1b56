/// Planes through points that are known up to Gaussian errors, and how well the points fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include <pelorus/matrix.hpp>

namespace plane_motion {

using pelorus::Matrix;
using pelorus::Vector;

/// A measured place.
struct Sample {
    std::int64_t time = 0;  ///< ns
    Vector<3> point;        ///< m
    Matrix<3> covariance;   ///< m^2, of its error
    template <class Archive> void state(Archive& archive) { archive(time, point, covariance); }
};

/// A range of samples.
struct Samples {
    std::deque<Sample>::const_iterator first, last;
    std::deque<Sample>::const_iterator begin() const noexcept { return first; }
    std::deque<Sample>::const_iterator end() const noexcept { return last; }
    std::size_t size() const noexcept { return static_cast<std::size_t>(last - first); }
};

/// What the numbers of a fit are worth.
enum class Status {
    tested,  ///< the statistic is one
    line,    ///< tested; but the points fit a line, which lies in many planes: the test rejects less often than it says
    few_points,    ///< fewer than 4 points: a plane goes through them whatever they are
    repeated,      ///< fewer than 4 different points, likewise
    no_variance,   ///< a point's error across the plane has no positive variance
    out_of_range,  ///< the numbers are too large to be squared, or no numbers
};

constexpr std::uint32_t status_count = 6;

inline bool is_tested(Status status) noexcept { return status == Status::tested || status == Status::line; }

/// The plane normal . p = offset. All numbers are 0 where it was not tested.
struct Fit {
    Status status = Status::few_points;
    double statistic = 0;  ///< chi-square distributed where the points are in a plane
    int degrees_of_freedom = 0;
    Vector<3> normal = Vector<3>::Zero();  ///< of length 1, its component of the largest size positive
    double offset = 0;                     ///< m
};

/// The plane of the least sum of squared distances over their variances, all errors counted: the minimum over the unit normal n and
/// the offset d of sum (n.z - d)^2 / (n' C n). Degrees of freedom: points - 3.
Fit errors_in_variables(const Samples& samples);

/// Coordinate `dependent` (0, 1, 2: x, y, z) regressed on an intercept and the other two, which are taken to be exact; weights
/// 1 / C[dependent, dependent]. The statistic is the weighted residual sum.
Fit regression_on(const Samples& samples, int dependent);

/// The regression with the least statistic of the three.
Fit regression(const Samples& samples);

/// How well points fit a line: the sum of squared distances over their covariances, chi-square distributed with 2 points - 4 degrees
/// of freedom where they are on a line. Infinite where they clearly are on none, and where it cannot be told.
double line_statistic(const Samples& samples);

}  // namespace plane_motion
