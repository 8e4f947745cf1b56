/// A waveform model asked in a test.
#pragma once

#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <Eigen/Dense>

#include "../../../tests/support/airship_parts.hpp"

namespace waveform {

/// What a scheduler knows of one look after another; matrices of later steps stand side by side.
struct Scene {
    Eigen::MatrixXd mean;              ///< c x h
    Eigen::MatrixXd covariance;        ///< c x (c h)
    Eigen::MatrixXd projected, cross;  ///< m x (m h), c x (m h)
    Eigen::MatrixXd base_noise;        ///< m x m
    std::vector<double> dt;            ///< h, s
    pelorus::Space space = pelorus::kinematic_space(2, {1, 1, 1});
};

/// The radar of the waveform scenario at the origin: range, range rate, azimuth, at a state of positions, velocities, accelerations.
inline Eigen::MatrixXd polar_slope(const Eigen::VectorXd& x) {
    const Eigen::Vector2d p = x.head(2), v = x.segment(2, 2);
    const double r = p.norm(), rate = p.dot(v) / r;
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(3, 6);
    h.block(0, 0, 1, 2) = p.transpose() / r;
    h.block(1, 0, 1, 2) = (v / r - rate * p / (r * r)).transpose();
    h.block(1, 2, 1, 2) = p.transpose() / r;
    h.block(2, 0, 1, 2) << -p(1) / (r * r), p(0) / (r * r);
    return h;
}

/// F = [1 T T^2/2; 0 1 T; 0 0 1] and q = g g', g = [T^2/2, T, 1], on both axes.
inline Eigen::MatrixXd acceleration_step(double t) {
    Eigen::MatrixXd f = Eigen::MatrixXd::Identity(6, 6);
    for (int axis = 0; axis < 2; ++axis) {
        f(axis, 2 + axis) = f(2 + axis, 4 + axis) = t;
        f(axis, 4 + axis) = t * t / 2;
    }
    return f;
}
inline Eigen::MatrixXd acceleration_noise(double t, double variance) {
    const Eigen::Vector3d g(t * t / 2, t, 1);
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(6, 6);
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            for (int axis = 0; axis < 2; ++axis) q(2 * r + axis, 2 * c + axis) = variance * g(r) * g(c);
    return q;
}

/// Predictions without updates from a posterior, over so many looks a second apart.
inline Scene scene_from(Eigen::VectorXd mean, Eigen::MatrixXd covariance, double variance, int horizon = 1) {
    Scene out;
    out.mean.resize(6, horizon);
    out.covariance.resize(6, 6 * horizon);
    out.projected.resize(3, 3 * horizon);
    out.cross.resize(6, 3 * horizon);
    out.dt.assign(static_cast<std::size_t>(horizon), 1.0);
    out.base_noise = Eigen::Vector3d(1e4, 1e2, 1e-8).asDiagonal();
    for (int j = 0; j < horizon; ++j) {
        mean = acceleration_step(1) * mean;
        covariance =
            acceleration_step(1) * covariance * acceleration_step(1).transpose() + acceleration_noise(1, variance);
        const Eigen::MatrixXd h = polar_slope(mean);
        out.mean.col(j) = mean;
        out.covariance.middleCols(6 * j, 6) = covariance;
        out.cross.middleCols(3 * j, 3) = covariance * h.transpose();
        out.projected.middleCols(3 * j, 3) = h * covariance * h.transpose();
    }
    return out;
}

/// The first look of the waveform scenario: the start that tests/reference/waveform_traces.json begins with (one deviation to +x
/// and to -y of the truth), and the variance of acceleration that its adaptive model finds there.
inline Scene first_look(int horizon = 1) {
    Eigen::VectorXd mean(6), deviations(6);
    deviations << 100, 100, 10, 10, 1, 1;
    mean << 432000 + 100, 88000 - 100, -2255 + 10, 397 - 10, 0 + 1, -10 - 1;
    return scene_from(mean, deviations.cwiseAbs2().asDiagonal(), 55.740867125973196, horizon);
}

class WaveformUnderTest {
public:
    struct Choice {
        Eigen::VectorXd waveform;
        Eigen::MatrixXd noise;
        double criterion;
    };

    explicit WaveformUnderTest(const std::string& name, const std::string& with,
                               std::vector<test_support::Part> parts = {})
        : instance_(bench_, test_support::plugin("waveform", name), with, std::move(parts)) {}

    const plr_waveform_info& info() const { return *table().info(instance_.self()); }

    Choice choose(const Scene& scene) const {
        const Eigen::Index m = scene.base_noise.rows();
        Choice out{Eigen::VectorXd(info().waveform->size), Eigen::MatrixXd(m, m), 0};
        auto args = pelorus::arguments<plr_waveform_choose>();
        args.mean = pelorus::const_view(scene.mean);
        args.covariance = pelorus::const_view(scene.covariance);
        args.projected = pelorus::const_view(scene.projected);
        args.cross = pelorus::const_view(scene.cross);
        args.base_noise = pelorus::const_view(scene.base_noise);
        args.waveform = pelorus::view(out.waveform);
        args.noise = pelorus::view(out.noise);
        args.criterion = pelorus::view(&out.criterion, 1, 1, 1);
        args.dt = pelorus::const_view(scene.dt.data(), static_cast<std::int64_t>(scene.dt.size()), 1, 1);
        args.cartesian = scene.space.c();
        test_support::Call call;
        const plr_status status = table().choose(instance_.self(), &call.raw(), &args);
        INFO(call.message());
        REQUIRE(status == PLR_OK);
        return out;
    }
    Eigen::MatrixXd noise(const Eigen::VectorXd& parameters, const Eigen::MatrixXd& base,
                          plr_status expected = PLR_OK) const {
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(base.rows(), base.cols());
        auto args = pelorus::arguments<plr_waveform_noise>();
        args.waveform = pelorus::const_view(parameters);
        args.base_noise = pelorus::const_view(base);
        args.out = pelorus::view(out);
        test_support::Call call;
        const plr_status status = table().noise(instance_.self(), &call.raw(), &args);
        CHECK(status == expected);
        return out;
    }

private:
    const plr_waveform& table() const { return instance_.table<plr_waveform>(); }
    test_support::Bench bench_;
    test_support::BenchInstance instance_;
};

/// P - P H' (H P H' + R)^-1 H P of the first look of a scene.
inline Eigen::MatrixXd posterior_of(const Scene& scene, const Eigen::MatrixXd& noise) {
    const Eigen::Index m = noise.rows(), c = scene.mean.rows();
    const Eigen::MatrixXd cross = scene.cross.leftCols(m);
    const Eigen::MatrixXd s = scene.projected.leftCols(m) + noise;
    return scene.covariance.leftCols(c) - cross * s.inverse() * cross.transpose();
}

}  // namespace waveform
