#include "search_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pointing_scheduler {

namespace {

/// How many fields to one side of the middle one reach as far as `reach` (rad), all of them within a right angle.
int rings(double reach, double side) {
    if (side <= 0 || reach <= side / 2) return 0;
    const double pitch = (1 - Field::overlap) * side, most = std::min(std::floor(1.5 / pitch), 200.0);
    return static_cast<int>(std::min(std::ceil((reach - side / 2) / pitch), most));
}

/// x' A^-1 x of the area's ellipse.
class Distance {
public:
    explicit Distance(const pelorus::Matrix<2>& area)
        : area_(area), determinant_(area(0, 0) * area(1, 1) - area(0, 1) * area(1, 0)) {}

    double operator()(double x, double y) const {
        if (determinant_ <= 0) return x * x / area_(0, 0);  // in the plane: nothing lies up
        return (area_(1, 1) * x * x - 2 * area_(0, 1) * x * y + area_(0, 0) * y * y) / determinant_;
    }
    /// Of the nearest point of a field that does not hold the prediction itself: it lies on an edge.
    double nearest(const sensing::Offset& at, const Field& field) const {
        double least = std::numeric_limits<double>::infinity();
        const double cross = determinant_ <= 0 ? 0 : area_(0, 1);
        for (const double side : {-0.5, 0.5}) {
            const double x = at.left + side * field.width, y = at.up + side * field.height;
            const double up = std::clamp(cross / area_(0, 0) * x, at.up - field.height / 2, at.up + field.height / 2);
            const double left = determinant_ <= 0 ? at.left
                                                  : std::clamp(cross / area_(1, 1) * y, at.left - field.width / 2,
                                                               at.left + field.width / 2);
            least = std::min({least, (*this)(x, up), (*this)(left, y)});
        }
        return least;
    }

private:
    pelorus::Matrix<2> area_;
    double determinant_;
};

}  // namespace

Field Field::of(const std::vector<double>& angles, bool in_plane) {
    if (in_plane) return {angles[0], 0};
    if (angles.size() == 1) return {angles[0] / std::sqrt(2.0), angles[0] / std::sqrt(2.0)};
    return {angles[0], angles[1]};
}

std::vector<Place> search_pattern(const Field& field, const pelorus::Matrix<2>& spread, double sigmas, double widened) {
    const pelorus::Matrix<2> area = sigmas * sigmas * spread + widened * widened * pelorus::Matrix<2>::Identity();
    const Distance distance(area);
    const int columns = rings(std::sqrt(area(0, 0)), field.width), rows = rings(std::sqrt(area(1, 1)), field.height);
    std::vector<std::pair<double, Place>> found{{0, {}}};
    for (int row = -rows; row <= rows; ++row)
        for (int column = -columns; column <= columns; ++column) {
            if (row == 0 && column == 0) continue;
            const sensing::Offset at{field.pitch().left * column, field.pitch().up * row};
            if (distance.nearest(at, field) <= 1) found.push_back({distance(at.left, at.up), {column, row, at}});
        }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Place> out;
    for (std::size_t k = 0; k < std::min(found.size(), most_fields); ++k) out.push_back(found[k].second);
    return out;
}

}  // namespace pointing_scheduler
