// Kernels over lanes for what points tell of a motion or a sensor. Includes nothing that has inline functions of its own: see
// plugins/common/lanes/pack.hpp.
#include "factor_kernels.hpp"
#include "groups.hpp"

namespace gaussian {

inline namespace PELORUS_LANES {

namespace {

using namespace lanes;

/// So many columns of residuals are held at a time.
constexpr int chunk = 16;

/// Points +-s on the axes: of a pair y+ y-, slope (y+ - y-)/(2s), and one residual of weight 1/s^2 for both, of the mean or of
/// the centre's image.
template <class R>
void regress_star(R size, const Regression& task, const Group& group, bool about_centre, Pack* shift, Pack* slope,
                  Pack* residual) noexcept {
    const int rows = size, pairs = task.points->size;
    const double scale = task.points->scale, root = 1.0 / scale, half = 0.5 / scale;
    Pack values[most_states<R> * (2 * max_state + 1)];
    const int first = rows;  // the centre's differences are 0
    load_items({task.differences.first + first, task.differences.stride}, group, 2 * pairs * rows, values);
    for (int r = 0; r < rows; ++r) {
        Pack sum{};
        for (int p = 0; p < 2 * pairs; ++p) sum += values[p * rows + r];
        shift[r] = pairs > 0 ? sum * task.points->mean_weights[1] : Pack{};
    }
    for (int j = 0; j < pairs; ++j) {
        for (int r = 0; r < rows; ++r) {
            const Pack above = values[2 * j * rows + r], below = values[(2 * j + 1) * rows + r];
            slope[j * rows + r] = (above - below) * half;
            residual[j * rows + r] = (0.5 * (above + below) - (about_centre ? Pack{} : shift[r])) * root;
        }
    }
}

/// Any points; the residuals are folded into their triangle.
template <class R>
void regress_each(R size, const Regression& task, const Group& group, Pack* shift, Pack* slope,
                  Pack* triangle) noexcept {
    const int rows = size;
    const Points& points = *task.points;
    constexpr int most = most_states<R>;
    const auto load_point = [&](int p, Pack* to) {
        load_items({task.differences.first + p * rows, task.differences.stride}, group, size, to);
    };
    Pack value[room(most)];
    for (int r = 0; r < rows; ++r) shift[r] = Pack{};
    for (int p = 1; p < points.count; ++p) {
        load_point(p, value);
        for (int r = 0; r < rows; ++r) shift[r] += points.mean_weights[p] * value[r];
    }
    for (int e = 0; e < rows * points.size; ++e) slope[e] = Pack{};
    for (int p = 1; p < points.count; ++p) {
        load_point(p, value);
        for (int j = 0; j < points.size; ++j) {
            const double factor = points.mean_weights[p] * points.points[p * points.size + j];
            for (int r = 0; r < rows; ++r) slope[j * rows + r] += factor * (value[r] - shift[r]);
        }
    }
    for (int e = 0; e < rows * rows; ++e) triangle[e] = Pack{};
    Pack columns[most * chunk];
    int filled = 0;
    for (int p = 1; p < points.count; ++p) {
        load_point(p, value);
        const Pack root = square_root(all(points.covariance_weights[p]));
        for (int r = 0; r < rows; ++r) {
            Pack rest = value[r] - shift[r];
            for (int j = 0; j < points.size; ++j) rest -= slope[j * rows + r] * points.points[p * points.size + j];
            columns[filled * rows + r] = root * rest;
        }
        if (++filled < chunk && p + 1 < points.count) continue;
        append_columns(size, filled, triangle, columns);
        filled = 0;
    }
}

template <class R> void regress_of(R size, const Regression& task) noexcept {
    const int rows = size, n = task.states, seen = task.points->size;
    constexpr int most = most_states<R>;
    const double weight = task.points->centre_weight;
    const Pack root = square_root(absolute(all(weight)));
    for (Group group{task.outcome, task.items}; group.is_left(); group.next()) {
        Pack shift[most], slope[most * max_state], residual[most * (max_state + 1)], column[most], mean[most];
        load_items(task.centre, group, size, mean);
        if (task.points->is_star)
            regress_star(size, task, group, task.points->about_centre, shift, slope, residual);
        else
            regress_each(size, task, group, shift, slope, residual);
        for (int r = 0; r < rows; ++r) {
            mean[r] += shift[r];
            column[r] = root * shift[r];
        }
        double* const kept = beside(task.kept, group, image_doubles(rows, n));
        double* const kept_residual = kept + rows * n * width;
        keep(slope, rows * seen, kept);
        if (weight > 0.0 && !task.points->is_star) append_columns(size, Fixed<1>{}, residual, column);
        keep(residual, rows * (task.points->is_star ? seen : rows), kept_residual);
        if (weight > 0.0 && task.points->is_star) keep(column, rows, kept_residual + rows * seen * width);
        if (weight < 0.0) keep(column, rows, kept_residual + rows * residual_columns(rows, n) * width);
        store_all(mean, size, group, task.mean);
    }
    leave_lanes();
}

}  // namespace

RegressionKernel regression(int rows) noexcept;
RegressionKernel regression(int rows) noexcept {
    if (rows == 2) return [](const Regression& task) { regress_of(Fixed<2>{}, task); };
    if (rows == 3) return [](const Regression& task) { regress_of(Fixed<3>{}, task); };
    if (rows == 6) return [](const Regression& task) { regress_of(Fixed<6>{}, task); };
    if (rows == 9) return [](const Regression& task) { regress_of(Fixed<9>{}, task); };
    return [](const Regression& task) { regress_of(task.rows, task); };
}

}  // namespace PELORUS_LANES

}  // namespace gaussian
