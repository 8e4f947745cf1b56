// The laws of a filter's step. Each compares one step with dense formulas, from the filter's own moments before it, so that errors
// do not add up; R. E. Kalman's equations (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and
// Navigation, 2001, 5.2).
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "estimator_bench.hpp"
#include "machine/bench.hpp"
#include "machine/check.hpp"

namespace pelorus::conformance {

namespace {

// Products of a few dozen terms round at 1e-14 of the largest; square-root and information forms lose by the condition of S and P
// (to some 1e4 here, squared by those that form inverses).
constexpr double rounding = 1e-8;

Eigen::VectorXd deviations(const Eigen::MatrixXd& covariance) {
    return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

/// Fails unless two matrices agree to `rounding` of the scales of row and column.
void same_matrix(const std::string& what, const Eigen::MatrixXd& told, const Eigen::MatrixXd& expected,
                 const Eigen::VectorXd& row_scale, const Eigen::VectorXd& col_scale,
                 const std::function<std::string(Eigen::Index, Eigen::Index)>& name) {
    for (Eigen::Index k = 0; k < expected.cols(); ++k)
        for (Eigen::Index r = 0; r < expected.rows(); ++r)
            if (!(std::abs(told(r, k) - expected(r, k)) <= rounding * row_scale(r) * col_scale(k)))
                FAIL(what << " " << name(r, k) << " is " << told(r, k) << ", expected " << expected(r, k));
}

struct Names {
    const plr_space &row, &col;
    std::string operator()(Eigen::Index r, Eigen::Index k) const {
        return "(" + component_name(row, r) + ", " + component_name(col, k) + ")";
    }
};

/// Some measurement of the sensor for one record, about as far off as its noise says, and the noise.
struct OneMeasured {
    Eigen::VectorXd measurement;
    Eigen::MatrixXd noise;
};
OneMeasured measure(const EstimatorBench& filter, std::int32_t sensor, const Argument& record, Sample& sample) {
    const Measured measured = measured_near(filter, sensor, record, sample);
    return {item(measured.measurement, 0).col(0), item(measured.noise, 0)};
}

}  // namespace

PELORUS_CHECK(estimator, "estimator-projects-without-noise", 3,
              "project answers H P H' without R, and update's S is that plus R; a gate adds the noise of each "
              "measurement itself.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    Sample sample = bench.sample();
    for (std::int32_t s = 0; s < static_cast<std::int32_t>(filter.info.sensor_count); ++s) {
        const Argument record = filter.tracks(sample, 1);
        const auto projected = filter.project_of(s, record);
        const OneMeasured measured = measure(filter, s, record, sample);
        const auto updated = filter.update_of(s, record, measured.measurement, measured.noise);
        const plr_space& space = *filter.sensor_info(s).measurement;
        const Eigen::VectorXd scale = deviations(projected.covariance + measured.noise);
        same_matrix("update: `innovation_covariance` minus R, compared with project's `covariance`: element",
                    updated.innovation_covariance - measured.noise, projected.covariance, scale, scale,
                    Names{space, space});
    }
}

PELORUS_CHECK(estimator, "estimator-cross-covariance", 3,
              "`cross` is P H' of the state and `cartesian_cross` that of the Cartesian components; schedulers and "
              "smoothers form gains of them.",
              {"estimator-projects-without-noise", "estimator-spaces-well-formed"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    const std::int32_t sensor = filter.linear_sensors().front();
    Sample sample = bench.sample();
    const Argument record = filter.tracks(sample, 1);
    const Gaussian state = filter.moments_of(record);
    const auto projected = filter.project_of(sensor, record);
    const Eigen::MatrixXd h = filter.sensor_jacobian(sensor, state.mean), cross = state.covariance * h.transpose();
    const Eigen::VectorXd scale = deviations(state.covariance), seen = deviations(h * cross);
    const plr_space& space = *filter.sensor_info(sensor).measurement;
    same_matrix("project: `covariance`, compared with H P H': element", projected.covariance, h * cross, seen, seen,
                Names{space, space});
    same_matrix("project: `cross`, compared with P H': element", projected.cross, cross, scale, seen,
                Names{*filter.info.state, space});
    same_matrix("project: `cartesian_cross`, compared with P H': element", projected.cartesian_cross, cross, scale,
                seen, Names{*filter.info.cartesian, space});
}

PELORUS_CHECK(estimator, "estimator-predicts-as-its-motion", 3,
              "The predicted mean is F x, and the predicted covariance F P F' + Q, or up to 30 % more in any direction "
              "where a filter forgets on purpose; one that is surer than its motion loses its target, and one that is "
              "much less sure takes in what is not its own.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    filter.wants_linear_motion();
    Sample sample = bench.sample();
    Argument record = filter.tracks(sample, 1);
    constexpr double most_forgotten = 0.3;  // a twentieth a second, over the longest step
    double most = 0;
    for (int k = 0; k < 8; ++k) {
        const Gaussian before = filter.moments_of(record);
        const double dt = sample.uniform(0.05, 5.0);
        const EstimatorBench::Step step = filter.motion_step(dt, before);
        const Eigen::VectorXd mean = step.transition * before.mean;
        const Eigen::MatrixXd covariance =
            step.transition * before.covariance * step.transition.transpose() + step.noise;
        record = filter.step(record, dt);
        const Gaussian after = filter.moments_of(record);
        const Eigen::VectorXd scale = deviations(covariance);
        for (Eigen::Index r = 0; r < mean.size(); ++r)
            if (!(std::abs(after.mean(r) - mean(r)) <= rounding * scale(r) + 1e-12 * std::abs(mean(r))))
                FAIL("predict by " << dt << " s: the mean of " << filter.state_name(r) << " is " << after.mean(r)
                                   << ", F x is " << mean(r));
        // Scaled to a unit diagonal, the difference may have no negative direction.
        const Eigen::VectorXd inverse = scale.cwiseInverse();
        const Eigen::MatrixXd more = inverse.asDiagonal() * (after.covariance - covariance) * inverse.asDiagonal();
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(more);
        if (!(eigen.eigenvalues()(0) >= -rounding)) {
            Eigen::Index r = 0;
            eigen.eigenvectors().col(0).cwiseAbs().maxCoeff(&r);
            FAIL("predict by " << dt << " s: the covariance is smaller than F P F' + Q, most along "
                               << filter.state_name(r) << ": its variance is " << after.covariance(r, r)
                               << ", that of F P F' + Q " << covariance(r, r));
        }
        const Eigen::MatrixXd expected = inverse.asDiagonal() * covariance * inverse.asDiagonal();
        most = std::max(most, Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(
                                  more, expected, Eigen::EigenvaluesOnly | Eigen::Ax_lBx)
                                  .eigenvalues()
                                  .maxCoeff());
        if (!(most <= most_forgotten))
            FAIL("predict by " << dt << " s: the covariance is up to " << 1e2 * most
                               << " % above F P F' + Q, more than " << 1e2 * most_forgotten << " %");
    }
    if (most > 1e-6) note("variances predicted up to " + std::to_string(1e2 * most) + " % above F P F' + Q");
}

PELORUS_CHECK(estimator, "estimator-updates-as-textbook", 3,
              "With a linear sensor the posterior is that of Kalman's equations: x + K e and P - K S K', with K = P H' "
              "S^-1; it is the best there is.",
              {"estimator-cross-covariance"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    const std::int32_t sensor = filter.linear_sensors().front();
    Sample sample = bench.sample();
    Argument record = filter.tracks(sample, 1);
    for (int k = 0; k < 8; ++k) {
        record = filter.step(record, sample.uniform(0.05, 2.0));
        const Gaussian before = filter.moments_of(record);
        const OneMeasured measured = measure(filter, sensor, record, sample);
        const Eigen::MatrixXd h = filter.sensor_jacobian(sensor, before.mean);
        const Eigen::MatrixXd s = h * before.covariance * h.transpose() + measured.noise;
        const Eigen::MatrixXd gain = s.ldlt().solve(h * before.covariance).transpose();
        const Eigen::VectorXd innovation = measured.measurement - filter.project_of(sensor, record).measurement;
        const auto updated = filter.update_of(sensor, record, measured.measurement, measured.noise);
        record = updated.record;
        const Gaussian after = filter.moments_of(record);
        const Eigen::VectorXd mean = before.mean + gain * innovation, scale = deviations(before.covariance);
        for (Eigen::Index r = 0; r < mean.size(); ++r)
            if (!(std::abs(after.mean(r) - mean(r)) <= rounding * scale(r) + 1e-12 * std::abs(mean(r))))
                FAIL("update " << k << ": the mean of " << filter.state_name(r) << " is " << after.mean(r)
                               << ", x + K e is " << mean(r) << " (before: " << before.mean(r) << ")");
        same_matrix("update " + std::to_string(k) + ": covariance, compared with P - K S K': element", after.covariance,
                    before.covariance - gain * s * gain.transpose(), scale, scale,
                    Names{*filter.info.state, *filter.info.state});
    }
}

PELORUS_CHECK(estimator, "estimator-likelihood-integrates-to-one", 3,
              "log_likelihood is the logarithm of a density over measurements: it integrates to one. Association and "
              "the weights of multiple-model filters compare it between tracks and models.",
              {"estimator-projects-without-noise"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    Sample sample = bench.sample();
    const Argument record = filter.tracks(sample, 1);
    const std::int64_t m = filter.measured(0);
    if (m > 3) skip("a measurement of more than 3 components");
    const auto projected = filter.project_of(0, record);
    const Eigen::MatrixXd noise = measure(filter, 0, record, sample).noise;
    const Eigen::MatrixXd root = Eigen::LLT<Eigen::MatrixXd>(projected.covariance + noise).matrixL();
    // The trapezoid rule over +-6 deviations by 0.75: exact to 1e-8 for a Gaussian; what a heavier tail leaves outside is within
    // the 2 % that are allowed.
    constexpr int half = 8;
    constexpr double spacing = 0.75;
    std::int64_t count = 1;
    for (std::int64_t r = 0; r < m; ++r) count *= 2 * half + 1;
    const Argument measurement = input("measurement", m, 1, count, [&](double* out, std::int64_t i) {
        Eigen::VectorXd white(m);
        for (Eigen::Index r = 0; r < m; ++r, i /= 2 * half + 1)
            white(r) = spacing * static_cast<double>(i % (2 * half + 1) - half);
        Eigen::Map<Eigen::VectorXd>(out, m) = projected.measurement + root * white;
    });
    Argument records = record, common = given("noise", noise);
    records.is_common = common.is_common = true;
    HotCall call = filter.update(0, records, measurement, common);
    call.count = count;
    ExecuteOptions fast;
    fast.is_guarded = false;
    const Execution done = execute_well(*instance, call, fast);
    double integral = 0;
    for (std::int64_t i = 0; i < count; ++i) integral += std::exp(done.out[1][static_cast<std::size_t>(i)]);
    integral *= std::pow(spacing, static_cast<double>(m)) * root.diagonal().prod();
    if (!(std::abs(integral - 1) <= 0.02))
        FAIL("update: exp(log_likelihood) integrates to " << integral << " over the measurements of a track (" << m
                                                          << " components), expected 1");
}

PELORUS_CHECK(
    estimator, "estimator-order-of-sensors-free", 3,
    "Two measurements of one time (of two linear sensors, or of one twice) give the same track in either order, "
    "and the same likelihood together; which sensor is asked first is chance.",
    {"estimator-updates-as-textbook"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    const std::vector<std::int32_t> sensors = filter.linear_sensors();
    Sample sample = bench.sample();
    const Argument record = filter.step(filter.tracks(sample, 1), 1.0);
    const std::pair<std::int32_t, OneMeasured> first{sensors.front(), measure(filter, sensors.front(), record, sample)},
        second{sensors.back(), measure(filter, sensors.back(), record, sample)};
    const auto both = [&](const auto& a, const auto& b) {
        const auto one = filter.update_of(a.first, record, a.second.measurement, a.second.noise);
        auto two = filter.update_of(b.first, one.record, b.second.measurement, b.second.noise);
        two.log_likelihood += one.log_likelihood;
        return two;
    };
    const auto here = both(first, second), there = both(second, first);
    const Gaussian one = filter.moments_of(here.record), other = filter.moments_of(there.record);
    const Eigen::VectorXd scale = deviations(filter.moments_of(record).covariance);
    for (Eigen::Index r = 0; r < scale.size(); ++r)
        if (!(std::abs(one.mean(r) - other.mean(r)) <= rounding * scale(r) + 1e-12 * std::abs(one.mean(r))))
            FAIL("two updates in either order: the mean of " << filter.state_name(r) << " is " << one.mean(r) << " and "
                                                             << other.mean(r));
    same_matrix("two updates in either order: covariance", one.covariance, other.covariance, scale, scale,
                Names{*filter.info.state, *filter.info.state});
    if (!(std::abs(here.log_likelihood - there.log_likelihood) <= 1e-7 * (1 + std::abs(here.log_likelihood))))
        FAIL("two updates in either order: the log-likelihoods sum to " << here.log_likelihood << " and "
                                                                        << there.log_likelihood);
}

PELORUS_CHECK(estimator, "estimator-survives-huge-prior", 3,
              "A track that starts from 1e24 m2 and is measured to 1 m is known to 1 m, and its covariance stays "
              "symmetric and positive through a thousand steps; P - K H P in floating point does not.",
              {"covariances-positive", "estimator-spaces-well-formed", "estimator-projects-without-noise"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    const std::int32_t sensor = filter.linear_sensors().front();
    const std::int64_t m = filter.measured(sensor), axes = filter.axes;
    Sample sample = bench.sample();
    std::vector<std::int32_t> positions;
    for (std::int32_t k = 0; k < axes; ++k) positions.push_back(k);
    Argument record = filter.run(filter.init(positions, given("mean", Eigen::VectorXd::Constant(axes, 1e3)),
                                             given("covariance", 1e24 * Eigen::MatrixXd::Identity(axes, axes))));
    const Eigen::MatrixXd noise = Eigen::MatrixXd::Identity(m, m);
    const EstimatorBench::Projection prior = filter.project_of(sensor, record);
    Eigen::VectorXd seen = prior.measurement;
    for (int k = 0; k < 1000; ++k) {
        if (k > 0) record = filter.step(record, 0.1);
        for (Eigen::Index r = 0; r < m; ++r) seen(r) += 0.1 * sample.normal();
        record = filter.update_of(sensor, record, seen, noise).record;
        if (k > 20 && k % 50 != 49) continue;
        const Gaussian state = filter.moments_of(record);
        const std::string when = "after update " + std::to_string(k + 1) + " from a prior of 1e24 m2: ";
        if (k == 0) {
            // H P H' = R - R S^-1 R, for positions R to 1e-24; Joseph's form rounds it at some 1e-32 of 1e24. Components of S
            // that are that far apart are solved for on a unit diagonal.
            const Eigen::MatrixXd s = prior.covariance + noise,
                                  projected = filter.project_of(sensor, record).covariance;
            const Eigen::VectorXd unit = deviations(s).cwiseInverse();
            const Eigen::MatrixXd scaled = unit.asDiagonal() * s * unit.asDiagonal(), root = unit.asDiagonal() * noise,
                                  expected = noise - root.transpose() * scaled.ldlt().solve(root);
            for (Eigen::Index r = 0; r < m; ++r)
                for (Eigen::Index c = 0; c < m; ++c)
                    if (!(std::abs(projected(r, c) - expected(r, c)) <= 1e-3))
                        FAIL(when << "H P H' "
                                  << Names{*filter.sensor_info(sensor).measurement,
                                           *filter.sensor_info(sensor).measurement}(r, c)
                                  << " is " << projected(r, c) << ", R - R S^-1 R is " << expected(r, c)
                                  << " (R is the identity)");
        }
        for (Eigen::Index c = 0; c < filter.n; ++c)
            for (Eigen::Index r = c + 1; r < filter.n; ++r)
                if (state.covariance(r, c) != state.covariance(c, r))
                    FAIL(when << "covariance (" << filter.state_name(r) << ", " << filter.state_name(c)
                              << ") differs from its mirror image by "
                              << state.covariance(r, c) - state.covariance(c, r));
        const Eigen::VectorXd inverse =
            deviations(state.covariance).unaryExpr([](double d) { return d > 0 ? 1 / d : 0.0; });
        const Eigen::MatrixXd scaled = inverse.asDiagonal() * state.covariance * inverse.asDiagonal();
        const double least =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()(0);
        if (!(state.covariance.diagonal().minCoeff() > 0 && least >= -1e-9))
            FAIL(when << "the covariance has a negative variance: least on the diagonal "
                      << state.covariance.diagonal().minCoeff() << ", least eigenvalue " << least
                      << " (scaled to a unit diagonal)");
    }
}

PELORUS_CHECK(estimator, "estimator-far-measurement-is-finite-or-flagged", 3,
              "A measurement absurdly far away gives a finite track or fails its item; one that gives NaN and PLR_OK "
              "takes everything along that it is compared with.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    Sample sample = bench.sample();
    const Argument record = filter.tracks(sample, 3);
    Measured measured = measured_near(filter, 0, record, sample);
    const std::int64_t m = filter.measured(0);
    for (std::int64_t r = 0; r < m; ++r) measured.measurement.values[static_cast<std::size_t>(m + r)] += 1e9;
    const HotCall call = filter.update(0, record, measured.measurement, measured.noise);
    const Execution done = execute(*instance, call);
    if (done.status != PLR_OK && done.status != PLR_ITEMS_FAILED)
        FAIL("update with one measurement 1e9 off among three answered " << done.told());
    if (done.failed(0) || done.failed(2)) FAIL("update fails a neighbour of the item whose measurement is 1e9 off");
    if (done.failed(1)) return;
    const char* const outputs[] = {"", "log_likelihood", "innovation", "innovation_covariance"};
    for (std::size_t o = 1; o < 4; ++o)
        for (const double value : HotCall::item_of(call.out[o], done.out[o], 1))
            if (!std::isfinite(value))
                FAIL("update with a measurement 1e9 off: `" << outputs[o] << "` is " << value << " and the item is not "
                                                            << "failed");
    const Gaussian state =
        filter.moments_of(EstimatorBench::item_of(EstimatorCalls::argument(call, done, 0, "record"), 1));
    if (!state.mean.allFinite() || !state.covariance.allFinite())
        FAIL(
            "update with a measurement 1e9 off: the record has moments that are not finite, and the item is not "
            "failed");
}

}  // namespace pelorus::conformance
