// The laws of filters that go back in time: what comes late, and what is known of the past.
#include <cmath>

#include <Eigen/Eigenvalues>

#include "estimator_bench.hpp"
#include "machine/bench.hpp"
#include "machine/check.hpp"

namespace pelorus::conformance {

namespace {

/// The same steps in another grouping; square roots lose to their condition.
constexpr double rounding = 1e-8;

struct Seen {
    Eigen::VectorXd measurement;
    Eigen::MatrixXd noise;
};
Seen seen_near(const EstimatorBench& filter, const Argument& record, Sample& sample) {
    const Measured measured = measured_near(filter, 0, record, sample);
    return {item(measured.measurement, 0).col(0), item(measured.noise, 0)};
}
Argument updated(const EstimatorBench& filter, const Argument& record, const Seen& seen) {
    return filter.update_of(0, record, seen.measurement, seen.noise).record;
}

void same_moments(const std::string& when, const EstimatorBench& filter, const Gaussian& told,
                  const Gaussian& expected) {
    const Eigen::VectorXd scale = expected.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    for (Eigen::Index r = 0; r < scale.size(); ++r) {
        if (!(std::abs(told.mean(r) - expected.mean(r)) <= rounding * scale(r) + 1e-12 * std::abs(expected.mean(r))))
            FAIL(when << ": the mean of " << filter.state_name(r) << " is " << told.mean(r) << ", in sequence it is "
                      << expected.mean(r));
        for (Eigen::Index k = 0; k <= r; ++k)
            if (!(std::abs(told.covariance(r, k) - expected.covariance(r, k)) <= rounding * scale(r) * scale(k)))
                FAIL(when << ": covariance (" << filter.state_name(r) << ", " << filter.state_name(k) << ") is "
                          << told.covariance(r, k) << ", in sequence it is " << expected.covariance(r, k));
    }
}

/// All that the extension tells of one record.
struct Past {
    std::int64_t known;
    Eigen::VectorXd age;
    Eigen::MatrixXd mean, covariance;
};
Past past_of(const EstimatorBench& filter, const Argument& record) {
    const HotCall call = filter.smoothed(record);
    const Execution done = execute_well(filter.instance, call);
    const auto matrix = [&](std::size_t o) -> Eigen::MatrixXd {
        return Eigen::Map<const Eigen::MatrixXd>(done.out[o].data(), call.out[o].rows, call.out[o].cols);
    };
    return {std::llround(done.out[0][0]), matrix(1), matrix(2), matrix(3)};
}

void examine_times(const Past& past, std::int64_t most, std::int64_t steps, double dt) {
    if (past.known < 1 || past.known > most)
        FAIL("smoothed tells of " << past.known << " times, expected 1 to " << most);
    for (std::int64_t k = 0; k < most; ++k) {
        const double expected = k < past.known ? static_cast<double>(k) * dt : 0;
        if (!(std::abs(past.age(k) - expected) <= 1e-9))
            FAIL("after " << steps << " steps of " << dt << " s, age " << k << " of " << past.known << " is "
                          << past.age(k) << " s, expected " << expected);
    }
}

/// Fails where the smoothed covariance is larger than the filtered one, in any direction.
void examine_gain(const EstimatorBench& filter, const Gaussian& filtered, const Eigen::MatrixXd& smoothed, double age) {
    const Eigen::VectorXd inverse =
        filtered.covariance.diagonal().cwiseMax(0.0).cwiseSqrt().unaryExpr([](double d) { return d > 0 ? 1 / d : 0; });
    const Eigen::MatrixXd less = inverse.asDiagonal() * (filtered.covariance - smoothed) * inverse.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(less);
    if (eigen.eigenvalues()(0) >= -rounding) return;
    Eigen::Index r = 0;
    eigen.eigenvectors().col(0).cwiseAbs().maxCoeff(&r);
    FAIL("smoothed, " << age << " s old: the covariance is larger than it was when filtered, most along "
                      << component_name(*filter.info.cartesian, r) << ": " << smoothed(r, r) << " instead of "
                      << filtered.covariance(r, r) << " or less");
}

}  // namespace

PELORUS_CHECK(estimator, "estimator-out-of-sequence-as-sorted", 3,
              "A filter that takes late measurements (PLR_ESTIMATOR_OUT_OF_SEQUENCE) answers, once it is back at its "
              "newest time, what it would have answered had they come in time.",
              {"numbers-finite", "estimator-backward-as-declared"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    if ((filter.info.flags & PLR_ESTIMATOR_OUT_OF_SEQUENCE) == 0) skip("does not take measurements late");
    Sample sample = bench.sample();
    for (int attempt = 0; attempt < 3; ++attempt) {
        const double dt = sample.uniform(0.1, 1.0);
        const Argument start = filter.step(filter.tracks(sample, 1), 1.0);
        const Seen first = seen_near(filter, start, sample);
        const Argument before = updated(filter, start, first);
        Argument sorted = filter.step(before, dt);
        const Gaussian predicted = filter.moments_of(sorted);
        const Seen late = seen_near(filter, sorted, sample);
        sorted = filter.step(updated(filter, sorted, late), dt);
        const Seen newest = seen_near(filter, sorted, sample);
        sorted = updated(filter, sorted, newest);

        Argument record = updated(filter, filter.step(before, 2 * dt), newest);
        record = filter.step(record, -dt);
        same_moments("gone back by " + std::to_string(dt) + " s", filter, filter.moments_of(record), predicted);
        record = filter.step(updated(filter, record, late), dt);
        same_moments("with a measurement that came " + std::to_string(dt) + " s late", filter,
                     filter.moments_of(record), filter.moments_of(sorted));
    }
}

PELORUS_CHECK(estimator, "estimator-smoothed-improves-on-filtered", 3,
              "What a filter tells of times past (" PLR_ESTIMATOR_SMOOTHED
              ") is known at least as well as it was then, and at age 0 it is what summary tells.",
              {"numbers-finite", "covariances-positive"}) {
    const auto instance = bench.make();
    const auto* const extension = instance->extension<plr_estimator_smoothed>(PLR_ESTIMATOR_SMOOTHED);
    if (extension == nullptr) skip("does not offer " PLR_ESTIMATOR_SMOOTHED);
    if (extension->most < 1) FAIL("smoothed: `most` is " << extension->most << ", expected 1 or more");
    const EstimatorBench filter(*instance);
    Sample sample = bench.sample();
    const std::int64_t most = extension->most, steps = std::min<std::int64_t>(most + 2, 20), c = filter.c;
    const double dt = sample.uniform(0.1, 2.0);
    std::vector<Gaussian> filtered;
    const plr_space& space = *filter.info.cartesian;
    Argument record = filter.start({sample.state(space), sample.covariance(space)});
    filtered.push_back(filter.summary_of(record));
    for (std::int64_t step = 1; step <= steps; ++step) {
        record = filter.step(record, dt);
        record = updated(filter, record, seen_near(filter, record, sample));
        filtered.push_back(filter.summary_of(record));
        const Past past = past_of(filter, record);
        examine_times(past, most, step, dt);
        if (past.mean.col(0) != filtered.back().mean || past.covariance.leftCols(c) != filtered.back().covariance)
            FAIL("smoothed, of age 0, is another estimate than summary tells: position "
                 << past.mean(0, 0) << " instead of " << filtered.back().mean(0));
        for (std::int64_t k = 0; k < std::min(past.known, step + 1); ++k)
            examine_gain(filter, filtered[static_cast<std::size_t>(step - k)], past.covariance.middleCols(k * c, c),
                         past.age(k));
    }
}

}  // namespace pelorus::conformance
