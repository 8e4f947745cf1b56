#include "overlap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <boost/math/tools/toms748_solve.hpp>
#include <pelorus/small_matrix.hpp>

namespace shape_error {

namespace {

using pelorus::Matrix;
using pelorus::Vector;

constexpr double pi = 3.14159265358979323846;

/// Centre and extent in the plane.
struct Ellipse {
    Vector<2> centre;
    Matrix<2> root;  // lower triangular L with X = L L': points are centre + L (cos, sin)
    double area() const { return pi * root(0, 0) * root(1, 1); }
    Vector<2> at(double angle) const {
        const double c = std::cos(angle), s = std::sin(angle);
        return {centre(0) + root(0, 0) * c, centre(1) + root(1, 0) * c + root(1, 1) * s};
    }
};

/// q(t) = a + b cos t + c sin t + d cos 2t + e sin 2t: how far the point t of one ellipse is out of another, -1 at its centre
/// and 0 on it.
class Outside {
public:
    Outside(const Ellipse& of, const Ellipse& other) {
        // In coordinates in which the other one is the unit circle, points are m + A (cos t, sin t).
        Matrix<2> a = of.root;
        Vector<2> m = of.centre - other.centre;
        pelorus::small::solve_lower(other.root, a);
        pelorus::small::solve_lower(other.root, m);
        const double u = a.col(0).squaredNorm(), v = a.col(1).squaredNorm();
        c_ = {m.squaredNorm() - 1 + 0.5 * (u + v), 2 * m.dot(a.col(0)), 2 * m.dot(a.col(1)), 0.5 * (u - v),
              a.col(0).dot(a.col(1))};
    }
    double operator()(double t) const {
        const double x = std::cos(t), y = std::sin(t);
        return c_[0] + c_[1] * x + c_[2] * y + c_[3] * (x * x - y * y) + c_[4] * 2 * x * y;
    }
    double slope(double t) const {
        const double x = std::cos(t), y = std::sin(t);
        return c_[2] * x - c_[1] * y + 2 * (c_[4] * (x * x - y * y) - c_[3] * 2 * x * y);
    }
    /// The largest that it can differ from 0 by.
    double size() const {
        return std::fabs(c_[0]) + std::fabs(c_[1]) + std::fabs(c_[2]) + std::fabs(c_[3]) + std::fabs(c_[4]);
    }

    /// Where it is 0, ascending in [0, 2 pi). Between two neighbouring extremes it is monotonous, so that a bracketing solver finds
    /// every root; the extremes are found in the same way, between points so close that a pair which is missed makes no difference.
    std::vector<double> roots() const {
        constexpr int steps = 48;
        std::vector<double> grid;
        for (int k = 0; k < steps; ++k) grid.push_back(2 * pi * k / steps);
        const std::vector<double> extremes = crossings(grid, [this](double t) { return slope(t); });
        std::vector<double> out = crossings(extremes, *this);
        for (double& root : out)
            if (root >= 2 * pi) root -= 2 * pi;
        std::sort(out.begin(), out.end());
        return out;
    }

private:
    /// Between neighbours (the last one's is the first, a turn later) where the function has other signs, where it is 0.
    template <class Function>
    static std::vector<double> crossings(const std::vector<double>& at, const Function& function) {
        std::vector<double> values, out;
        for (const double t : at) values.push_back(function(t));
        for (std::size_t k = 0; k < at.size(); ++k) {
            const std::size_t next = (k + 1) % at.size();
            const double from = at[k], to = next == 0 ? at[0] + 2 * pi : at[next];
            if ((values[k] < 0) == (values[next] < 0)) continue;
            if (values[k] == 0 || values[next] == 0) {
                out.push_back(values[k] == 0 ? from : to);
                continue;
            }
            std::uintmax_t most = 60;
            const auto bracket = boost::math::tools::toms748_solve(function, from, to, values[k], values[next],
                                                                   boost::math::tools::eps_tolerance<double>(50), most);
            out.push_back(0.5 * (bracket.first + bracket.second));
        }
        return out;
    }

    std::array<double, 5> c_{};
};

/// 1/2 of the integral of x dy - y dx along the arcs of `of` that are within `other`.
double within(const Ellipse& of, const Outside& outside) {
    const std::vector<double> ends = outside.roots();
    if (ends.empty()) return outside(0) < 0 ? of.area() : 0;
    double area = 0;
    for (std::size_t k = 0; k < ends.size(); ++k) {
        const double from = ends[k], to = k + 1 < ends.size() ? ends[k + 1] : ends[0] + 2 * pi;
        if (!(outside(0.5 * (from + to)) < 0)) continue;
        const Vector<2> chord = of.at(to) - of.at(from);
        area += 0.5 * (of.root(0, 0) * of.root(1, 1) * (to - from) + of.centre(0) * chord(1) - of.centre(1) * chord(0));
    }
    return area;
}

double common_area(const Ellipse& one, const Ellipse& other) {
    const Outside first(one, other), second(other, one);
    // Equal but for so little that rounding would decide which arcs are within.
    if (first.size() < 1e-8) return one.area();
    const double area = within(one, first) + within(other, second);
    return std::min({std::max(area, 0.0), one.area(), other.area()});
}

/// The slice at height z of an ellipsoid about `centre`; empty where `scale` is not positive.
struct Slices {
    Vector<3> centre;
    Matrix<3> extent, root;

    /// (x, y) given z of a vector with covariance X: the Schur complement, scaled by what is left of the unit ball.
    bool at(double z, Ellipse& out) const {
        const double height = z - centre(2), scale = 1 - height * height / extent(2, 2);
        if (!(scale > 0)) return false;
        for (int k = 0; k < 2; ++k) out.centre(k) = centre(k) + extent(k, 2) / extent(2, 2) * height;
        Matrix<2> flat;
        for (int col = 0; col < 2; ++col)
            for (int row = 0; row < 2; ++row)
                flat(row, col) = scale * (extent(row, col) - extent(row, 2) * extent(col, 2) / extent(2, 2));
        return pelorus::small::cholesky(flat, out.root);
    }
    double reach() const { return std::sqrt(extent(2, 2)); }
};

/// Points and weights of Gauss and Legendre's rule of 8 points in [-1, 1], the positive half.
constexpr std::array<std::array<double, 2>, 4> rule{{{0.1834346424956498, 0.3626837833783620},
                                                     {0.5255324099163290, 0.3137066458778873},
                                                     {0.7966664774136267, 0.2223810344533745},
                                                     {0.9602898564975363, 0.1012285362903763}}};

double common_volume(const Slices& one, const Slices& other) {
    const double from = std::max(one.centre(2) - one.reach(), other.centre(2) - other.reach());
    const double to = std::min(one.centre(2) + one.reach(), other.centre(2) + other.reach());
    if (!(from < to)) return 0;
    constexpr int panels = 16;
    const double half = 0.5 * (to - from) / panels;
    double volume = 0;
    for (int panel = 0; panel < panels; ++panel)
        for (const auto& [point, weight] : rule)
            for (const double sign : {-1.0, 1.0}) {
                Ellipse first, second;
                const double z = from + half * (2 * panel + 1 + sign * point);
                if (one.at(z, first) && other.at(z, second)) volume += half * weight * common_area(first, second);
            }
    return volume;
}

double share(double common, double one, double other) { return common / (one + other - common); }

}  // namespace

double intersection_over_union(const Vector<2>& offset, const Matrix<2>& one, const Matrix<2>& other) {
    Ellipse first{offset, {}}, second{Vector<2>::Zero(), {}};
    if (!pelorus::small::cholesky(one, first.root) || !pelorus::small::cholesky(other, second.root))
        return std::nan("");
    return share(common_area(first, second), first.area(), second.area());
}

double intersection_over_union(const Vector<3>& offset, const Matrix<3>& one, const Matrix<3>& other) {
    Slices first{offset, one, {}}, second{Vector<3>::Zero(), other, {}};
    if (!pelorus::small::cholesky(one, first.root) || !pelorus::small::cholesky(other, second.root))
        return std::nan("");
    const auto volume = [](const Slices& of) { return 4 * pi / 3 * of.root(0, 0) * of.root(1, 1) * of.root(2, 2); };
    return share(common_volume(first, second), volume(first), volume(second));
}

}  // namespace shape_error
