/// Where a narrow field has to look one after the other to cover the place in which something is likely to be.
#pragma once

#include <cstdint>
#include <vector>

#include <pelorus/matrix.hpp>

#include "../../common/sensing/direction.hpp"

namespace pointing_scheduler {

/// A field of view: full angles (rad) across.
struct Field {
    static constexpr double overlap = 0.2;  ///< of neighbours, for what moves meanwhile

    double width = 0, height = 0;  ///< of the window that lies within the field: of a cone, the square in it

    /// From the middle of a field to that of its neighbours.
    sensing::Offset pitch() const noexcept { return {(1 - overlap) * width, (1 - overlap) * height}; }
    /// One angle: a cone; two: a window. `in_plane`: the one angle is a sector.
    static Field of(const std::vector<double>& angles, bool in_plane);
};

/// A field of the pattern: which one of the grid, and where its middle lies from the prediction.
struct Place {
    std::int32_t column = 0, row = 0;
    sensing::Offset at;

    bool same(const Place& other) const noexcept { return column == other.column && row == other.row; }
    template <class Archive> void state(Archive& archive) { archive(column, row, at.left, at.up); }
};

/// The middles of fields that cover the area, likeliest first: the one about the prediction, then by growing distance, measured in
/// deviations of the prediction.
///     area: { x : x' A^-1 x <= 1 },   A = sigmas^2 P + widened^2 I
/// P: covariance of the prediction to the left and up (rad^2); `sigmas`: how many deviations are covered; `widened` (rad): by how much
/// the area is larger than that. At most `most_fields`, the likeliest.
std::vector<Place> search_pattern(const Field& field, const pelorus::Matrix<2>& spread, double sigmas, double widened);

inline constexpr std::size_t most_fields = 1000;

}  // namespace pointing_scheduler
