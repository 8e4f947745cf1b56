#include "inline/track_filter.hpp"

#include <cmath>
#include <limits>

namespace plain {

namespace {

constexpr int n = states, m = measured;

struct Look {
    double jacobian[m * n];  // column-major
};

/// 0 x is NaN for every x that is not finite. Several sums, so that one addition need not wait for the one before it.
template <std::size_t Size> bool all_finite(const std::array<double, Size>& numbers) {
    constexpr std::size_t lanes = 8, whole = Size - Size % lanes;
    double sum[lanes] = {};
    for (std::size_t k = 0; k < whole; k += lanes)
        for (std::size_t lane = 0; lane < lanes; ++lane) sum[lane] += 0.0 * numbers[k + lane];
    for (std::size_t k = whole; k < Size; ++k) sum[0] += 0.0 * numbers[k];
    for (std::size_t lane = 1; lane < lanes; ++lane) sum[0] += sum[lane];
    return sum[0] == 0.0;
}

double wrapped(double angle) {
    constexpr double pi = 3.14159265358979323846;
    if (angle > -pi && angle <= pi) return angle;
    const double nearest = std::remainder(angle, 2 * pi);
    return nearest <= -pi ? pi : nearest;
}

/// F = F1 (x) I and Q = Q1 (x) I: the blocks act on all axes alike, a third of the work of full products.
bool predict_one(const double (&f1)[9], const double (&q1)[9], const Track& from, Track& to) {
    constexpr int b = derivatives, d = axes;
    Track next;
    double left[n * n];  // F P
    for (int c = 0; c <= n; ++c) {
        const double* const column = c < n ? &from.covariance[static_cast<std::size_t>(c * n)] : from.mean.data();
        double* const out = c < n ? left + c * n : next.mean.data();
        for (int r = 0; r < b; ++r) {
            double sum[d] = {};
            for (int k = 0; k < b; ++k) {
                for (int axis = 0; axis < d; ++axis) sum[axis] += column[k * d + axis] * f1[k * b + r];
            }
            for (int axis = 0; axis < d; ++axis) out[r * d + axis] = sum[axis];
        }
    }
    double* const p = next.covariance.data();
    for (int r = 0; r < b; ++r) {
        for (int axis = 0; axis < d; ++axis) {
            const int column = r * d + axis;
            double sum[n] = {};
            for (int k = 0; k < b; ++k) {
                for (int i = column; i < n; ++i) sum[i] += left[(k * d + axis) * n + i] * f1[k * b + r];
            }
            for (int k = r; k < b; ++k) sum[k * d + axis] += q1[r * b + k];
            for (int i = column; i < n; ++i) p[column * n + i] = p[i * n + column] = sum[i];
        }
    }
    if (!all_finite(next.mean) || !all_finite(next.covariance)) return false;
    to = next;
    return true;
}

Seen look_at_position(const double* position) {
    Seen seen{};
    for (int r = 0; r < m; ++r) {
        seen.predicted[r] = position[r];
        seen.jacobian[r * m + r] = 1.0;
    }
    return seen;
}

Seen look_spherical(const Mount& mount, const double* position) {
    const auto& rotation = mount.rotation;
    double p[3] = {};
    for (int r = 0; r < 3; ++r) {
        for (int k = 0; k < 3; ++k) {
            p[r] += rotation[static_cast<std::size_t>(r * 3 + k)] *
                    (position[k] - mount.position[static_cast<std::size_t>(k)]);
        }
    }
    const double ground = std::hypot(p[0], p[1]), range = std::hypot(ground, p[2]);
    const double rise = p[2] / range / ground / range;
    const double along[9] = {p[0] / range,          -p[1] / ground / ground,
                             -p[0] * rise,  //
                             p[1] / range,          p[0] / ground / ground,
                             -p[1] * rise,  //
                             p[2] / range,          0.0,
                             ground / range / range};
    Seen seen{};
    seen.predicted[0] = range + mount.bias[0];
    seen.predicted[1] = wrapped(std::atan2(p[1], p[0]) + mount.bias[1]);
    seen.predicted[2] = std::atan2(p[2], ground) + mount.bias[2];
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 3; ++k) {
            const double factor = rotation[static_cast<std::size_t>(k * 3 + c)];
            for (int r = 0; r < m; ++r) seen.jacobian[c * m + r] += along[k * m + r] * factor;
        }
    }
    return seen;
}

/// L L' = A for a covariance that may be singular; a pivot that rounding has eaten is raised to what rounding leaves.
template <int Size> bool cholesky(const double* a, double* l) {
    constexpr double floor = Size * std::numeric_limits<double>::epsilon();
    double check = 0.0;
    for (int j = 0; j < Size; ++j) {
        double column[Size];
        for (int i = j; i < Size; ++i) column[i] = a[j * Size + i];
        const double diagonal = column[j];
        for (int k = 0; k < j; ++k) {
            for (int i = j; i < Size; ++i) column[i] -= l[k * Size + i] * l[k * Size + j];
        }
        if (!(column[j] >= -1e-8 * diagonal)) return false;
        const double root = std::sqrt(std::fmax(std::fabs(column[j]), floor * diagonal));
        const double inverse = root > 0.0 ? 1.0 / root : 0.0;
        for (int i = 0; i < j; ++i) l[j * Size + i] = 0.0;
        l[j * Size + j] = root;
        check += 0.0 * root;
        for (int i = j + 1; i < Size; ++i) l[j * Size + i] = column[i] * inverse;
    }
    return check == 0.0;
}

/// Householder reflections from the right: the m x (n + m) array becomes lower triangular, its product with its own
/// transpose stays.
void triangularise(double (&x)[m * (n + m)]) {
    constexpr int cols = n + m;
    for (int r = 0; r < m; ++r) {
        double v[cols] = {}, tail = 0.0;
        for (int j = r; j < cols; ++j) v[j] = x[j * m + r];
        for (int j = r + 1; j < cols; ++j) tail += v[j] * v[j];
        const double head = v[r];
        if (!(tail > 0.0)) {
            if (head < 0.0) {
                for (int i = r; i < m; ++i) x[r * m + i] = -x[r * m + i];
            }
            continue;
        }
        const double norm = std::sqrt(head * head + tail);
        v[r] = head <= 0.0 ? head - norm : -tail / (head + norm);
        const double beta = 2.0 / (v[r] * v[r] + tail);
        double dot[m] = {};
        for (int j = r; j < cols; ++j) {
            for (int i = r; i < m; ++i) dot[i] += x[j * m + i] * v[j];
        }
        for (int j = r; j < cols; ++j) {
            for (int i = r + 1; i < m; ++i) x[j * m + i] -= dot[i] * (beta * v[j]);
            x[j * m + r] = 0.0;
        }
        x[r * m + r] = norm;
    }
}

/// Joseph's form from factors: P = L L', R = N N', G = H L, S = T T' with T the triangle of [G N].
bool update_one(const Look& look, const double (&innovation)[m], const Measurement& z, const Track& from, Track& to,
                double& log_likelihood) {
    double l[n * n], noise[m * m];
    if (!cholesky<n>(from.covariance.data(), l) || !cholesky<m>(z.noise.data(), noise)) return false;

    double g[m * n] = {}, joined[m * (n + m)];
    for (int c = 0; c < n; ++c) {
        for (int k = 0; k < n; ++k) {
            for (int r = 0; r < m; ++r) g[c * m + r] += look.jacobian[k * m + r] * l[c * n + k];
        }
        for (int r = 0; r < m; ++r) joined[c * m + r] = g[c * m + r];
    }
    for (int e = 0; e < m * m; ++e) joined[m * n + e] = noise[e];
    triangularise(joined);
    const double* const t = joined;  // m x m, lower triangular
    for (int i = 0; i < m; ++i) {
        if (!(t[i * m + i] > 0.0)) return false;
    }

    double weighted[m * n];  // S^-1 G
    for (int c = 0; c < n; ++c) {
        double* const x = weighted + c * m;
        for (int i = 0; i < m; ++i) x[i] = g[c * m + i];
        for (int j = 0; j < m; ++j) {
            x[j] /= t[j * m + j];
            for (int i = j + 1; i < m; ++i) x[i] -= t[j * m + i] * x[j];
        }
        for (int j = m - 1; j >= 0; --j) {
            for (int i = j + 1; i < m; ++i) x[j] -= t[j * m + i] * x[i];
            x[j] /= t[j * m + j];
        }
    }
    double gain[n * m];  // K = L (S^-1 G)'
    for (int j = 0; j < m; ++j) {
        double sum[n] = {};
        for (int k = 0; k < n; ++k) {
            for (int i = 0; i < n; ++i) sum[i] += l[k * n + i] * weighted[k * m + j];
        }
        for (int i = 0; i < n; ++i) gain[j * n + i] = sum[i];
    }

    Track next = from;
    for (int i = 0; i < n; ++i) {
        double shift = 0.0;
        for (int k = 0; k < m; ++k) shift += gain[k * n + i] * innovation[k];
        next.mean[static_cast<std::size_t>(i)] += shift;
    }
    double rest[n * n], share[n * m];  // L - K G, K N
    for (int j = 0; j < n; ++j) {
        double sum[n] = {};
        for (int k = 0; k < m; ++k) {
            for (int i = 0; i < n; ++i) sum[i] += gain[k * n + i] * g[j * m + k];
        }
        for (int i = 0; i < n; ++i) rest[j * n + i] = l[j * n + i] - sum[i];
    }
    for (int j = 0; j < m; ++j) {
        double sum[n] = {};
        for (int k = 0; k < m; ++k) {
            for (int i = 0; i < n; ++i) sum[i] += gain[k * n + i] * noise[j * m + k];
        }
        for (int i = 0; i < n; ++i) share[j * n + i] = sum[i];
    }
    double* const p = next.covariance.data();
    for (int j = 0; j < n; ++j) {
        double sum[n] = {};
        for (int k = 0; k < n; ++k) {
            for (int i = j; i < n; ++i) sum[i] += rest[k * n + i] * rest[k * n + j];
        }
        for (int k = 0; k < m; ++k) {
            for (int i = j; i < n; ++i) sum[i] += share[k * n + i] * share[k * n + j];
        }
        for (int i = j; i < n; ++i) p[j * n + i] = p[i * n + j] = sum[i];
    }

    constexpr double log_two_pi = 1.8378770664093454836;
    double log_determinant = 0.0, distance = 0.0, scaled[m];
    for (int j = 0; j < m; ++j) log_determinant += 2.0 * std::log(t[j * m + j]);
    for (int j = 0; j < m; ++j) {
        scaled[j] = innovation[j];
        for (int k = 0; k < j; ++k) scaled[j] -= t[k * m + j] * scaled[k];
        scaled[j] /= t[j * m + j];
        distance += scaled[j] * scaled[j];
    }
    log_likelihood = -0.5 * (m * log_two_pi + log_determinant + distance);
    if (!all_finite(next.mean) || !all_finite(next.covariance)) return false;
    to = next;
    return true;
}

}  // namespace

bool predict(const Track* from, Track* to, std::size_t count, double dt, double jerk) {
    const double square = dt * dt;
    const double pp = dt * square * square / 20.0 * jerk, pv = square * square / 8.0 * jerk,
                 pa = dt * square / 6.0 * jerk;
    const double vv = dt * square / 3.0 * jerk, va = square / 2.0 * jerk, aa = dt * jerk;
    const double f1[9] = {1.0, 0.0, 0.0, dt, 1.0, 0.0, square / 2.0, dt, 1.0};
    const double q1[9] = {pp, pv, pa, pv, vv, va, pa, va, aa};
    for (std::size_t i = 0; i < count; ++i) {
        if (!predict_one(f1, q1, from[i], to[i])) return false;
    }
    return true;
}

Seen look(Sensor sensor, const Mount& mount, const double* position) {
    return sensor == Sensor::position ? look_at_position(position) : look_spherical(mount, position);
}

void residual(Sensor sensor, const Measurement& measurement, const Seen& seen, double (&out)[measured]) {
    for (std::size_t r = 0; r < measured; ++r) out[r] = measurement.value[r] - seen.predicted[r];
    if (sensor == Sensor::spherical) {
        out[1] = wrapped(out[1]);
        out[2] = wrapped(out[2]);
    }
}

bool update(Sensor sensor, const Mount& mount, const Track* from, const Measurement* measurements, Track* to,
            double* log_likelihood, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        const Seen seen = plain::look(sensor, mount, from[i].mean.data());
        double innovation[m];
        residual(sensor, measurements[i], seen, innovation);
        Look look{};
        for (int e = 0; e < m * axes; ++e) look.jacobian[e] = seen.jacobian[e];
        if (!update_one(look, innovation, measurements[i], from[i], to[i], log_likelihood[i])) return false;
    }
    return true;
}

}  // namespace plain
