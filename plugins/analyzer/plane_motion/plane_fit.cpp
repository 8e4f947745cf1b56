#include "plane_fit.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace plane_motion {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr int most_iterations = 60;
constexpr double smallest_step =
    1e-11;  // of a unit normal; the statistic is stationary there, so it has twice the digits

using Eigensystem = Eigen::SelfAdjointEigenSolver<Matrix<3>>;

/// Whether there is anything to be tested.
Status first_look(const Samples& samples) {
    if (samples.size() < 4) return Status::few_points;
    std::array<Vector<3>, 3> found;
    std::size_t count = 0;
    for (const Sample& sample : samples) {
        bool known = false;
        for (std::size_t k = 0; k < count; ++k) known = known || found[k] == sample.point;
        if (known) continue;
        if (count == found.size()) return Status::tested;
        found[count++] = sample.point;
    }
    return Status::repeated;
}

Vector<3> mean_point(const Samples& samples) {
    // About the first one: differences of far points keep their digits.
    Vector<3> sum = Vector<3>::Zero();
    for (const Sample& sample : samples) sum += sample.point - samples.first->point;
    return samples.first->point + sum / static_cast<double>(samples.size());
}

Matrix<3> scatter_of(const Samples& samples) {
    const Vector<3> mean = mean_point(samples);
    Matrix<3> out = Matrix<3>::Zero();
    for (const Sample& sample : samples) {
        const Vector<3> e = sample.point - mean;
        out += e * e.transpose();
    }
    return out;
}

Fit without_numbers(Status status) {
    Fit out;
    out.status = status;
    return out;
}

/// Settles the sign of the normal, and what the numbers are worth.
Fit settled(Fit fit, const Samples& samples) {
    if (!std::isfinite(fit.statistic) || !fit.normal.allFinite() || !std::isfinite(fit.offset))
        return without_numbers(Status::out_of_range);
    Eigen::Index largest = 0;
    fit.normal.cwiseAbs().maxCoeff(&largest);
    if (fit.normal(largest) < 0) {
        fit.normal = -fit.normal;
        fit.offset = -fit.offset;
    }
    fit.status = Status::tested;
    fit.degrees_of_freedom = static_cast<int>(samples.size()) - 3;
    return fit;
}

/// One pass over the samples for a normal: how they fit, and the matrix whose eigenvector of the eigenvalue nearest 0 is the next
/// normal. False where an error across the plane has no variance.
struct Pass {
    double statistic = 0, offset = 0;
    Matrix<3> slope = Matrix<3>::Zero();

    bool run(const Samples& samples, const Vector<3>& normal) {
        double total = 0;
        Vector<3> sum = Vector<3>::Zero();
        const Vector<3>& origin = samples.first->point;
        for (const Sample& sample : samples) {
            const double variance = normal.dot(sample.covariance * normal);
            if (!(variance > 1e-14 * sample.covariance.trace())) return false;
            total += 1 / variance;
            sum += (sample.point - origin) / variance;
        }
        const Vector<3> mean = sum / total;
        for (const Sample& sample : samples) {
            const double weight = 1 / normal.dot(sample.covariance * normal);
            const Vector<3> e = sample.point - origin - mean;
            const double distance = normal.dot(e);
            statistic += weight * distance * distance;
            slope += weight * e * e.transpose() - weight * weight * distance * distance * sample.covariance;
        }
        offset = normal.dot(origin) + normal.dot(mean);
        return true;
    }
};

/// Two directions across a line.
Eigen::Matrix<double, 3, 2> across(const Vector<3>& along) {
    Eigen::Index least = 0;
    along.cwiseAbs().minCoeff(&least);
    Eigen::Matrix<double, 3, 2> out;
    out.col(0) = along.cross(Vector<3>::Unit(least)).normalized();
    out.col(1) = along.cross(out.col(0));
    return out;
}

}  // namespace

Fit errors_in_variables(const Samples& samples) {
    const Status look = first_look(samples);
    if (look != Status::tested) return without_numbers(look);
    const Matrix<3> scatter = scatter_of(samples);
    if (!scatter.allFinite()) return without_numbers(Status::out_of_range);
    Vector<3> normal = Eigensystem(scatter).eigenvectors().col(0);
    Fit best;
    best.statistic = infinite;
    for (int k = 0; k < most_iterations; ++k) {
        Pass pass;
        if (!pass.run(samples, normal)) return without_numbers(Status::no_variance);
        if (!pass.slope.allFinite()) return without_numbers(Status::out_of_range);
        if (pass.statistic < best.statistic) {
            best.statistic = pass.statistic;
            best.normal = normal;
            best.offset = pass.offset;
        }
        const Eigensystem system(pass.slope);
        Eigen::Index nearest = 0;
        system.eigenvalues().cwiseAbs().minCoeff(&nearest);
        const Vector<3> next = system.eigenvectors().col(nearest);
        const double step = (next.dot(normal) < 0 ? Vector<3>(next + normal) : Vector<3>(next - normal)).norm();
        if (step < smallest_step) break;
        normal = next;
    }
    return settled(best, samples);
}

Fit regression_on(const Samples& samples, int dependent) {
    const Status look = first_look(samples);
    if (look != Status::tested) return without_numbers(look);
    const int one = (dependent + 1) % 3, other = (dependent + 2) % 3;
    const Vector<3>& origin = samples.first->point;
    double total = 0;
    Vector<3> sum = Vector<3>::Zero();
    for (const Sample& sample : samples) {
        const double variance = sample.covariance(dependent, dependent);
        if (!(variance > 0)) return without_numbers(Status::no_variance);
        total += 1 / variance;
        sum += (sample.point - origin) / variance;
    }
    const Vector<3> mean = sum / total;
    Matrix<3> scatter = Matrix<3>::Zero();
    for (const Sample& sample : samples) {
        const Vector<3> e = sample.point - origin - mean;
        scatter += e * e.transpose() / sample.covariance(dependent, dependent);
    }
    if (!scatter.allFinite()) return without_numbers(Status::out_of_range);
    Matrix<2> inner;
    inner << scatter(one, one), scatter(one, other), scatter(other, one), scatter(other, other);
    const Vector<2> with(scatter(one, dependent), scatter(other, dependent));
    // Regressors on a line leave one of their combinations open; it is taken to be 0, and the residuals are the same.
    const Eigen::SelfAdjointEigenSolver<Matrix<2>> system(inner);
    Vector<2> slope = Vector<2>::Zero();
    for (int k = 0; k < 2; ++k)
        if (system.eigenvalues()(k) > 1e-12 * system.eigenvalues()(1))
            slope += system.eigenvectors().col(k) * (system.eigenvectors().col(k).dot(with) / system.eigenvalues()(k));
    Fit fit;
    Vector<3> normal = Vector<3>::Unit(dependent);
    normal(one) = -slope(0);
    normal(other) = -slope(1);
    for (const Sample& sample : samples) {
        const double residual = normal.dot(sample.point - origin - mean);
        fit.statistic += residual * residual / sample.covariance(dependent, dependent);
    }
    fit.normal = normal.normalized();
    fit.offset = fit.normal.dot(origin) + fit.normal.dot(mean);
    return settled(fit, samples);
}

Fit regression(const Samples& samples) {
    Fit best = regression_on(samples, 0);
    for (int dependent = 1; dependent < 3; ++dependent) {
        const Fit fit = regression_on(samples, dependent);
        if (is_tested(fit.status) && (!is_tested(best.status) || fit.statistic < best.statistic)) best = fit;
    }
    return best;
}

double line_statistic(const Samples& samples) {
    if (samples.size() < 3) return infinite;
    const Matrix<3> scatter = scatter_of(samples);
    if (!scatter.allFinite()) return infinite;
    double spread = 0;
    for (const Sample& sample : samples) spread += sample.covariance.trace();
    const Eigensystem system(scatter);
    // Points that scatter to two sides by several times their errors are on no line, and need no closer look.
    if (!(system.eigenvalues()(1) < 9 * spread)) return infinite;
    Vector<3> along = system.eigenvectors().col(2), centre = mean_point(samples);
    double statistic = infinite;
    for (int k = 0; k < 4; ++k) {
        const Eigen::Matrix<double, 3, 2> sides = across(along);
        // Offsets to two sides and their slopes along the line, by weighted least squares.
        Matrix<4> normal = Matrix<4>::Zero();
        Vector<4> right = Vector<4>::Zero();
        double sum = 0;
        const double scale = std::sqrt(system.eigenvalues()(2) / static_cast<double>(samples.size()));
        for (const Sample& sample : samples) {
            const Vector<3> e = sample.point - centre;
            const double at = along.dot(e) / scale;
            const Vector<2> off = sides.transpose() * e;
            const Matrix<2> covariance = sides.transpose() * sample.covariance * sides;
            const Eigen::LLT<Matrix<2>> root(covariance);
            if (root.info() != Eigen::Success || !(covariance.determinant() > 0)) return infinite;
            const Matrix<2> weight = root.solve(Matrix<2>::Identity());
            const Vector<2> pull = weight * off;
            sum += off.dot(pull);
            normal.topLeftCorner<2, 2>() += weight;
            normal.topRightCorner<2, 2>() += at * weight;
            normal.bottomRightCorner<2, 2>() += at * at * weight;
            right.head<2>() += pull;
            right.tail<2>() += at * pull;
        }
        normal.bottomLeftCorner<2, 2>() = normal.topRightCorner<2, 2>();
        const Vector<4> move = normal.ldlt().solve(right);
        if (!move.allFinite()) return statistic;
        statistic = sum - right.dot(move);
        centre += sides * move.head<2>();
        along = (along + sides * move.tail<2>() / scale).normalized();
    }
    return statistic;
}

}  // namespace plane_motion
