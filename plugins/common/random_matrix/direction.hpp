/// Directions of flight, and the smallest rotation from one to another.
#pragma once

#include <cmath>
#include <optional>

#include <pelorus/abi/extent.h>
#include <pelorus/matrix.hpp>

namespace random_matrix {

using pelorus::Matrix;
using pelorus::Vector;

/// The direction of a velocity; nothing where it stands still. Throws NumericError where the velocity is no number.
template <int D> std::optional<Vector<D>> direction_of(const Vector<D>& velocity) {
    const double speed = velocity.stableNorm();
    if (!std::isfinite(speed)) throw pelorus::NumericError("the velocity is not finite");
    if (!(speed > 0)) return std::nullopt;
    return Vector<D>(velocity / speed);
}

/// The smallest rotation that brings the unit vector `from` to the unit vector `to`:
/// I - (from + to)(from + to)'/(1 + from'to) + 2 to from'. Nothing where they are so nearly opposite that it has no plane.
template <int D> std::optional<Matrix<D>> smallest_rotation(const Vector<D>& from, const Vector<D>& to) {
    const double cosine = from.dot(to);
    if (!(cosine > -0.99)) return std::nullopt;
    const Vector<D> sum = from + to;
    return Matrix<D>(Matrix<D>::Identity() - sum * sum.transpose() / (1.0 + cosine) + 2.0 * to * from.transpose());
}

/// The smallest rotation from the direction of one velocity to that of another, where both have one.
template <int D> std::optional<Matrix<D>> turn_of(const Vector<D>& before, const Vector<D>& after) {
    const auto from = direction_of<D>(before), to = direction_of<D>(after);
    return from && to ? smallest_rotation<D>(*from, *to) : std::nullopt;
}

/// Throws ArgumentError unless the kinematics have velocities: c x 1 of each item, positions first, then velocities.
template <int D> void expect_velocities(const plr_const_view& kinematics, std::int64_t count, const char* what) {
    if (kinematics.data == nullptr || kinematics.rows < 2 * D)
        throw pelorus::ArgumentError(std::string(what) + ": positions and velocities are needed, got " +
                                     std::to_string(kinematics.rows) + " components");
    pelorus::expect(kinematics, kinematics.rows, 1, count, what);
}
template <int D> void expect_velocities(const plr_extent_predict& args) {
    expect_velocities<D>(args.before, args.out.count, "before");
    expect_velocities<D>(args.after, args.out.count, "after");
}

/// The velocity in the kinematics of item i: c x 1, positions first, then velocities.
template <int D> Vector<D> velocity_of(const plr_const_view& kinematics, std::int64_t i) {
    Vector<D> out;
    for (int k = 0; k < D; ++k) out(k) = kinematics.data[i * kinematics.item_stride + (D + k) * kinematics.row_stride];
    return out;
}

}  // namespace random_matrix
