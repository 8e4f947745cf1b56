#include "inline/dense_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace dense {

namespace {

using Square = Eigen::Matrix<double, 9, 9>;
using State = Eigen::Matrix<double, 9, 1>;
using Small = Eigen::Matrix3d;

}  // namespace

void predict(const plain::Track* from, plain::Track* to, std::size_t count, double dt, double jerk) {
    const double square = dt * dt;
    Small f1, q1;
    f1 << 1.0, dt, square / 2.0, 0.0, 1.0, dt, 0.0, 0.0, 1.0;
    q1 << dt * square * square / 20.0, square * square / 8.0, dt * square / 6.0,  //
        square * square / 8.0, dt * square / 3.0, square / 2.0,                   //
        dt * square / 6.0, square / 2.0, dt;
    Square f, q;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
            f.block<3, 3>(3 * r, 3 * c) = f1(r, c) * Small::Identity();
            q.block<3, 3>(3 * r, 3 * c) = jerk * q1(r, c) * Small::Identity();
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Map<const State> x(from[i].mean.data());
        const Eigen::Map<const Square> p(from[i].covariance.data());
        const State mean = f * x;
        const Square covariance = f * p * f.transpose() + q;
        Eigen::Map<State>(to[i].mean.data()) = mean;
        Eigen::Map<Square>(to[i].covariance.data()) = covariance;
    }
}

void update(const plain::Track* from, const plain::Measurement* measurements, plain::Track* to, double* log_likelihood,
            std::size_t count) {
    Eigen::Matrix<double, 3, 9> h = Eigen::Matrix<double, 3, 9>::Zero();
    h.leftCols<3>().setIdentity();
    for (std::size_t i = 0; i < count; ++i) {
        const Eigen::Map<const State> x(from[i].mean.data());
        const Eigen::Map<const Square> p(from[i].covariance.data());
        const Eigen::Map<const Small> r(measurements[i].noise.data());
        const Eigen::Vector3d innovation = Eigen::Map<const Eigen::Vector3d>(measurements[i].value.data()) - h * x;
        const Eigen::Matrix<double, 9, 3> cross = p * h.transpose();
        const Eigen::LLT<Small> s(h * cross + r);
        const Eigen::Matrix<double, 9, 3> gain = s.solve(cross.transpose()).transpose();
        const State mean = x + gain * innovation;
        const Square rest = Square::Identity() - gain * h;
        const Square covariance = rest * p * rest.transpose() + gain * r * gain.transpose();
        const Small factor = s.matrixL();
        const double distance = innovation.dot(s.solve(innovation));
        log_likelihood[i] =
            -0.5 * (3.0 * 1.8378770664093454836 + 2.0 * factor.diagonal().array().log().sum() + distance);
        Eigen::Map<State>(to[i].mean.data()) = mean;
        Eigen::Map<Square>(to[i].covariance.data()) = covariance;
    }
}

}  // namespace dense
