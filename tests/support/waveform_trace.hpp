// The noise-free run of the waveform-scheduling paper: a target in the plane that manoeuvres twice, a radar at the origin that
// measures range, range rate and azimuth. See tests/reference/waveform_traces.json.
#pragma once

#include "motion_filter.hpp"

namespace test_support {

/// Positions, velocities, accelerations at 0, 1, ..., 150 s. The acceleration is linear within a stretch, right-continuous, and
/// integrated exactly.
inline std::vector<Eigen::VectorXd> waveform_truth() {
    struct Stretch {
        int seconds;
        Eigen::Vector2d acceleration, jerk;
    };
    const Stretch stretches[] = {{40, {0, -10}, {0, 0}},  {10, {-20, -10}, {3, 13}}, {50, {0, -10}, {0, 0}},
                                 {5, {-5, -10}, {1, 10}}, {5, {0, 40}, {1, -10}},    {41, {0, -10}, {0, 0}}};
    std::vector<Eigen::VectorXd> truth;
    Eigen::Vector2d position(432e3, 88e3), velocity(-2255, 397);
    for (const Stretch& stretch : stretches) {
        for (int second = 0; second < stretch.seconds; ++second) {
            const Eigen::Vector2d acceleration = stretch.acceleration + second * stretch.jerk;
            truth.emplace_back(6);
            truth.back() << position, velocity, acceleration;
            position += velocity + acceleration / 2.0 + stretch.jerk / 6.0;
            velocity += acceleration + stretch.jerk / 2.0;
        }
    }
    return truth;
}

/// Range, range rate, azimuth of (x, y, vx, vy, ...).
inline Eigen::VectorXd waveform_measurement(const Eigen::VectorXd& x) {
    const double range = std::hypot(x(0), x(1));
    return Eigen::Vector3d(range, (x(0) * x(2) + x(1) * x(3)) / range, std::atan2(x(1), x(0)));
}

/// Runs a motion of two axes through the run and compares with the reference's entry, to 1e-6 of each number, or to 1e-8 of its
/// deviation where an error is next to nothing beside positions of hundreds of kilometres.
inline void check_waveform_trace(const Instance& motion, const std::string& entry) {
    const auto reference_of = reference("waveform_traces.json");
    const auto& steps = reference_of.at(entry);
    const std::vector<Eigen::VectorXd> truth = waveform_truth();
    const std::vector<int> order{0, 2, 4, 1, 3, 5};  // of the reference's x, vx, ax, y, vy, ay
    Eigen::VectorXd start(6), deviations(6), accuracy(3);
    start << 100, -100, 10, -10, 1, -1;
    deviations << 100, 100, 10, 10, 1, 1;
    accuracy << 100, 10, 1e-4;
    const Eigen::MatrixXd r = accuracy.cwiseAbs2().asDiagonal();
    MotionFilter filter(motion, truth[0] + start, deviations.cwiseAbs2().asDiagonal());
    filter.draw_in_order(order);
    const auto wrap = [](Eigen::VectorXd& e) { e(2) = std::remainder(e(2), 2.0 * std::acos(-1.0)); };
    int compared = 0;
    for (int k = 1; k <= 150; ++k) {
        const auto at = static_cast<std::size_t>(k);
        filter.predict(1.0);
        filter.update(waveform_measurement(truth[at]), r, waveform_measurement, wrap);
        if (!steps.contains(std::to_string(k))) continue;
        const auto& step = steps.at(std::to_string(k));
        INFO(entry << ", step " << k);
        ++compared;
        for (int i = 0; i < 6; ++i) {
            const double error = step.at("err").at(static_cast<std::size_t>(i)),
                         deviation = step.at("sd").at(static_cast<std::size_t>(i));
            const int own = order[static_cast<std::size_t>(i)];
            CHECK(filter.mean()(own) - truth[at](own) == Approx(error).epsilon(1e-6).margin(1e-8 * deviation));
            CHECK(std::sqrt(filter.covariance()(own, own)) == Approx(deviation).epsilon(1e-6));
        }
        if (!step.contains("sigma2")) continue;
        for (int axis = 0; axis < 2; ++axis) {
            const double variance = step.at("sigma2").at(static_cast<std::size_t>(axis));
            CHECK(filter.process_noise()(4 + axis, 4 + axis) == Approx(variance).epsilon(1e-6));
        }
    }
    CHECK(compared == 11);
}

}  // namespace test_support
