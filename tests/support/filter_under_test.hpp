// A filter with its motion and one sensor, stepped one call at a time; what goes wrong throws.
#pragma once

#include "estimator_under_test.hpp"

namespace test_support {

struct FilterUnderTest {
    FilterUnderTest(const std::string& name, const Values& values, const std::string& motion_name,
                    const Values& motion_values, const std::string& sensor_name, const Values& sensor_values = {})
        : motion("motion", motion_name, motion_values),
          sensor("sensor", sensor_name, sensor_values),
          instance("estimator", name, values, {{"motion", "", &motion}, {"sensors", "radar", &sensor}}),
          filter(instance) {}
    FilterUnderTest(const std::string& name, const Values& values, const plr_plugin& motion_plugin,
                    const plr_plugin& sensor_plugin, const Values& motion_values = {})
        : motion(motion_plugin, motion_values, {}, 0),
          sensor(sensor_plugin, {}, {}, 0),
          instance("estimator", name, values, {{"motion", "", &motion}, {"sensors", "radar", &sensor}}),
          filter(instance) {}

    Batch record_of(const Eigen::VectorXd& x, const Eigen::MatrixXd& p) const { return filter.record_of(x, p); }
    Batch predicted(double dt, const Batch& record) const {
        Call call(record.count);
        Batch out(filter.record_size(), 1, record.count);
        finish(call, filter.predict(call, pelorus::common_view(&dt, 1, 1, record.count), record, out));
        return out;
    }
    /// One item's update; what it tells besides stays in `told`.
    Batch updated(const Eigen::VectorXd& z, const Eigen::MatrixXd& noise, const Batch& record) {
        Call call;
        const std::int64_t m = z.size();
        Batch measured(m, 1), out(filter.record_size(), 1);
        measured[0] = z;
        EstimatorUnderTest::Told all(m, 1);
        finish(call, filter.update(call, 0, record, measured, pelorus::const_view(noise.data(), m, m, 1), out, all));
        told = {all.innovation[0], all.covariance[0], all.log_likelihood[0](0)};
        return out;
    }
    struct Projection {
        Eigen::VectorXd measurement;
        Eigen::MatrixXd covariance, cross, cartesian_cross;
    };
    Projection projected(const Batch& record) const {
        Call call;
        const std::int64_t m = filter.m(0);
        Batch seen(m, 1), covariance(m, m), cross(filter.n(), m), cartesian(filter.c(), m);
        finish(call, filter.project(call, 0, record, seen, covariance, cross, &cartesian));
        return {seen[0], covariance[0], cross[0], cartesian[0]};
    }
    Eigen::VectorXd mean(const Batch& record, std::int64_t i = 0) const { return moments(record, i).first; }
    Eigen::MatrixXd covariance(const Batch& record, std::int64_t i = 0) const { return moments(record, i).second; }
    std::pair<Eigen::VectorXd, Eigen::MatrixXd> moments(const Batch& record, std::int64_t i = 0) const {
        Call call(record.count);
        Batch x(filter.n(), 1, record.count), p(filter.n(), filter.n(), record.count);
        finish(call, filter.moments(call, record, x, p));
        return {x[i], p[i]};
    }

    struct Told {
        Eigen::VectorXd innovation;
        Eigen::MatrixXd covariance;
        double log_likelihood = 0.0;
    };

    Instance motion, sensor, instance;
    EstimatorUnderTest filter;
    Told told;

private:
    static void finish(const Call& call, plr_status status) {
        if (status != PLR_OK) throw std::runtime_error(call.message());
        if (call.scratch_used() != 0) throw std::runtime_error("scratch memory was not given back");
    }
};

inline double relative(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    if (a.rows() != b.rows() || a.cols() != b.cols()) return std::numeric_limits<double>::infinity();
    return (a - b).cwiseAbs().maxCoeff() / std::max(1e-300, b.cwiseAbs().maxCoeff());
}

/// The largest difference of two covariances, each element by the deviations of its row and column.
inline double covariance_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    if (a.rows() != b.rows() || a.cols() != b.cols()) return std::numeric_limits<double>::infinity();
    const Eigen::VectorXd scale = b.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

}  // namespace test_support
