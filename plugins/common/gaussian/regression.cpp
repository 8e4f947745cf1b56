// Points of a state's distribution, and what their images tell.
#include "regression.hpp"

#include <cmath>

namespace gaussian {

namespace {

/// Points +-s on the axes: of a pair y+ y-, slope (y+ - y-)/(2s), and one residual of weight 1/s^2 for both, of the mean or of
/// the centre's image.
int regress_star(const PointRule& rule, std::int64_t rows, bool about_centre, double* values, double* shift,
                 double* slope) noexcept {
    if (rule.size == 0) return 0;
    const double weight = rule.mean_weights[1], root = 1.0 / rule.scale, half = 0.5 / rule.scale;
    for (std::int64_t p = 1; p < rule.count(); ++p) {
        for (std::int64_t r = 0; r < rows; ++r) shift[r] += values[p * rows + r];
    }
    for (std::int64_t r = 0; r < rows; ++r) shift[r] *= weight;
    for (std::int64_t j = 0; j < rule.size; ++j) {
        const double* const plus = values + (1 + 2 * j) * rows;
        const double* const minus = plus + rows;
        for (std::int64_t r = 0; r < rows; ++r) {
            const double above = plus[r], below = minus[r];
            slope[j * rows + r] = (above - below) * half;
            values[j * rows + r] = (0.5 * (above + below) - (about_centre ? 0.0 : shift[r])) * root;
        }
    }
    return static_cast<int>(rule.size);
}

/// The sum of a rule's weights in covariances: 1, but for the unscented transform.
double covariance_sum(const PointRule& rule) noexcept {
    const auto pairs = static_cast<double>(rule.count() - 1);
    return rule.is_star && rule.size > 0 ? rule.covariance_weights[0] + pairs * rule.covariance_weights[1] : 1.0;
}

/// Any points; the residual of the centre is left to the caller.
int regress_points(const PointRule& rule, std::int64_t rows, double* values, double* shift, double* slope) noexcept {
    for (std::int64_t p = 1; p < rule.count(); ++p) {
        const double weight = rule.mean_weights[static_cast<std::size_t>(p)];
        for (std::int64_t r = 0; r < rows; ++r) shift[r] += weight * values[p * rows + r];
    }
    for (std::int64_t p = 1; p < rule.count(); ++p) {
        const double weight = rule.mean_weights[static_cast<std::size_t>(p)];
        for (std::int64_t j = 0; j < rule.size; ++j) {
            const double factor = weight * rule.point(p)[j];
            for (std::int64_t r = 0; r < rows; ++r) slope[j * rows + r] += factor * (values[p * rows + r] - shift[r]);
        }
    }
    for (std::int64_t p = 1; p < rule.count(); ++p) {
        const double root = std::sqrt(rule.covariance_weights[static_cast<std::size_t>(p)]);
        for (std::int64_t r = 0; r < rows; ++r) {
            double rest = values[p * rows + r] - shift[r];
            for (std::int64_t j = 0; j < rule.size; ++j) rest -= slope[j * rows + r] * rule.point(p)[j];
            values[(p - 1) * rows + r] = root * rest;
        }
    }
    return static_cast<int>(rule.count() - 1);
}

}  // namespace

void place_points(const PointRule& rule, const double* mean, const double* factor, std::int64_t n,
                  const std::vector<std::int64_t>& rows, double* out) noexcept {
    const auto count = static_cast<std::int64_t>(rows.size());
    for (std::int64_t k = 0; k < count; ++k) out[k] = mean[rows[static_cast<std::size_t>(k)]];
    for (std::int64_t p = 1; p < rule.count(); ++p) {
        double* const point = out + p * count;
        std::copy_n(out, count, point);
        const std::int64_t first = rule.is_star ? (p - 1) / 2 : 0, end = rule.is_star ? first + 1 : rule.size;
        for (std::int64_t j = first; j < end; ++j) {
            const double coordinate = rule.point(p)[j];
            for (std::int64_t k = 0; k < count; ++k)
                point[k] += factor[j * n + rows[static_cast<std::size_t>(k)]] * coordinate;
        }
    }
}

Image regress(const PointRule& rule, std::int64_t n, std::int64_t rows, double* values, double* shift, double* slope,
              double* downdate) noexcept {
    std::fill_n(shift, rows, 0.0);
    std::fill_n(slope, rows * n, 0.0);
    Image image{slope, values, 0, nullptr};
    // The centre's residual is -shift. Its weight may be negative; then, of differences d from the centre's image,
    //     sum w (d - shift)(d - shift)' = sum w d d' + (sum w - 2) shift shift'
    // may hold nothing negative, and does not cancel where points lie close to the centre.
    double weight = rule.covariance_weights[0];
    const double about = covariance_sum(rule) - 2.0;
    const bool about_centre = rule.is_star && weight < 0.0 && about >= 0.0;
    if (about_centre) weight = about;
    const double root = std::sqrt(std::fabs(weight));
    image.columns = rule.is_star ? regress_star(rule, rows, about_centre, values, shift, slope)
                                 : regress_points(rule, rows, values, shift, slope);
    if (weight == 0.0) return image;
    double* const column = weight > 0.0 ? values + image.columns * rows : downdate;
    for (std::int64_t r = 0; r < rows; ++r) column[r] = root * shift[r];
    if (weight > 0.0)
        ++image.columns;
    else
        image.downdate = downdate;
    return image;
}

}  // namespace gaussian
