/// Points of a scan sorted into cells, so that a track meets its neighbours only.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace point_target {

using Point = std::array<double, 3>;

class MeasurementGrid {
public:
    /// About one point a cell. Cells divide the first two axes (the first, where there is one). Points are finite.
    void build(const std::vector<Point>& points, int axes) {
        const std::size_t n = points.size();
        const double per_axis = axes > 1 ? std::sqrt(static_cast<double>(n)) : static_cast<double>(n);
        for (std::size_t a = 0; a < 2; ++a) {
            const bool divided = n > 0 && static_cast<int>(a) < axes;
            low_[a] = high_[a] = divided ? points.front()[a] : 0;
            for (const Point& p : points)
                if (divided) {
                    low_[a] = std::min(low_[a], p[a]);
                    high_[a] = std::max(high_[a], p[a]);
                }
            count_[a] = high_[a] > low_[a] ? std::max<std::size_t>(1, static_cast<std::size_t>(per_axis)) : 1;
        }
        first_.assign(count_[0] * count_[1] + 1, 0);
        for (const Point& p : points) ++first_[cell(p) + 1];
        for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
        members_.resize(n);
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (std::size_t i = 0; i < n; ++i) members_[next[cell(points[i])]++] = i;
    }

    /// Calls take(index) for every point within `radius` of a place, and for some others.
    template <class Take> void near(const Point& place, double radius, Take take) const {
        if (members_.empty()) return;
        std::array<std::size_t, 2> from{}, to{};
        for (std::size_t a = 0; a < 2; ++a) {
            if (count_[a] > 1 && (place[a] + radius < low_[a] || place[a] - radius > high_[a])) return;
            from[a] = along(a, place[a] - radius);
            to[a] = along(a, place[a] + radius);
        }
        for (std::size_t y = from[1]; y <= to[1]; ++y) {
            const std::size_t row = y * count_[0];
            for (std::size_t i = first_[row + from[0]]; i < first_[row + to[0] + 1]; ++i) take(members_[i]);
        }
    }

private:
    std::size_t along(std::size_t axis, double x) const {
        if (count_[axis] == 1) return 0;
        const double share = (x - low_[axis]) / (high_[axis] - low_[axis]) * static_cast<double>(count_[axis]);
        return static_cast<std::size_t>(std::clamp(share, 0.0, static_cast<double>(count_[axis] - 1)));
    }
    std::size_t cell(const Point& p) const { return along(1, p[1]) * count_[0] + along(0, p[0]); }

    std::array<double, 2> low_{}, high_{};
    std::array<std::size_t, 2> count_{1, 1};
    std::vector<std::size_t> first_, members_;  // members of cell i: first_[i] .. first_[i + 1] - 1
};

}  // namespace point_target
