#include "inline/dense_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace dense {

namespace {

template <int N> using Square = Eigen::Matrix<double, N, N>;
template <int N> using State = Eigen::Matrix<double, N, 1>;
using Small = Eigen::Matrix3d;

/// F1 and Q1 of white noise in the highest derivative.
template <int B> void blocks(double dt, Square<B>& f1, Square<B>& q1) {
    const double square = dt * dt;
    if constexpr (B == 2) {
        f1 << 1.0, dt, 0.0, 1.0;
        q1 << dt * square / 3.0, square / 2.0, square / 2.0, dt;
    } else {
        f1 << 1.0, dt, square / 2.0, 0.0, 1.0, dt, 0.0, 0.0, 1.0;
        q1 << dt * square * square / 20.0, square * square / 8.0, dt * square / 6.0,  //
            square * square / 8.0, dt * square / 3.0, square / 2.0,                   //
            dt * square / 6.0, square / 2.0, dt;
    }
}

}  // namespace

template <int B> void predict(const double* from, double* to, std::size_t count, double dt, double density) {
    constexpr int n = 3 * B, size = n + n * n;
    Square<B> f1, q1;
    blocks<B>(dt, f1, q1);
    Square<n> f, q;
    for (int r = 0; r < B; ++r) {
        for (int c = 0; c < B; ++c) {
            f.template block<3, 3>(3 * r, 3 * c) = f1(r, c) * Small::Identity();
            q.template block<3, 3>(3 * r, 3 * c) = density * q1(r, c) * Small::Identity();
        }
    }
    for (std::size_t i = 0; i < count; ++i, from += size, to += size) {
        const Eigen::Map<const State<n>> x(from);
        const Eigen::Map<const Square<n>> p(from + n);
        const State<n> mean = f * x;
        const Square<n> covariance = f * p * f.transpose() + q;
        Eigen::Map<State<n>> mean_out(to);
        Eigen::Map<Square<n>> covariance_out(to + n);
        mean_out = mean;
        covariance_out = covariance;
    }
}

template <int B>
void update(plain::Sensor sensor, const plain::Mount& mount, const double* from, const plain::Measurement* measurements,
            double* to, double* log_likelihood, std::size_t count) {
    constexpr int n = 3 * B, size = n + n * n;
    Eigen::Matrix<double, 3, n> h = Eigen::Matrix<double, 3, n>::Zero();
    for (std::size_t i = 0; i < count; ++i, from += size, to += size) {
        const Eigen::Map<const State<n>> x(from);
        const Eigen::Map<const Square<n>> p(from + n);
        const Eigen::Map<const Small> r(measurements[i].noise.data());
        const plain::Seen seen = plain::look(sensor, mount, from);
        h.template leftCols<3>() = Eigen::Map<const Small>(seen.jacobian);
        double difference[3];
        plain::residual(sensor, measurements[i], seen, difference);
        const Eigen::Vector3d innovation(difference[0], difference[1], difference[2]);
        const Eigen::Matrix<double, n, 3> cross = p * h.transpose();
        const Eigen::LLT<Small> s(h * cross + r);
        const Eigen::Matrix<double, n, 3> gain = s.solve(cross.transpose()).transpose();
        const State<n> mean = x + gain * innovation;
        const Square<n> rest = Square<n>::Identity() - gain * h;
        const Square<n> covariance = rest * p * rest.transpose() + gain * r * gain.transpose();
        const Small factor = s.matrixL();
        const double distance = innovation.dot(s.solve(innovation));
        log_likelihood[i] =
            -0.5 * (3.0 * 1.8378770664093454836 + 2.0 * factor.diagonal().array().log().sum() + distance);
        Eigen::Map<State<n>> mean_out(to);
        Eigen::Map<Square<n>> covariance_out(to + n);
        mean_out = mean;
        covariance_out = covariance;
    }
}

template void predict<2>(const double*, double*, std::size_t, double, double);
template void predict<3>(const double*, double*, std::size_t, double, double);
template void update<2>(plain::Sensor, const plain::Mount&, const double*, const plain::Measurement*, double*, double*,
                        std::size_t);
template void update<3>(plain::Sensor, const plain::Mount&, const double*, const plain::Measurement*, double*, double*,
                        std::size_t);

}  // namespace dense
