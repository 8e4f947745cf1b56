// Whether a filter knows how wrong it is.
#include <cmath>

#include <Eigen/Cholesky>

#include "estimator_bench.hpp"
#include "machine/bench.hpp"
#include "machine/check.hpp"

namespace pelorus::conformance {

namespace {

/// Quantile of chi-square with many degrees of freedom (E. B. Wilson, M. M. Hilferty, 1931); z is that of the standard normal.
double chi_square_quantile(double degrees, double z) {
    const double a = 2 / (9 * degrees);
    return degrees * std::pow(1 - a + z * std::sqrt(a), 3);
}

/// x' P^-1 x, summed.
double normalised(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
    return error.dot(covariance.ldlt().solve(error));
}

}  // namespace

PELORUS_CHECK(estimator, "estimator-errors-match-covariance", 4,
              "Simulated from the filter's own models, its errors have the covariance that it tells (NEES) and its "
              "innovations theirs (NIS); gates, associations and users rely on it.",
              {"estimator-predicts-as-its-motion", "estimator-updates-as-textbook"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    filter.wants_linear_motion();
    const std::int32_t sensor = filter.linear_sensors().front();
    Sample sample = bench.sample();
    constexpr int runs = 200, steps = 60;
    constexpr double dt = 1.0;
    const plr_space& space = *filter.info.cartesian;
    const Gaussian start{Eigen::VectorXd::Zero(filter.c), sample.covariance(space)};
    const plr_space& seen = *filter.sensor_info(sensor).measurement;
    const Eigen::MatrixXd noise = sample.covariance(Eigen::VectorXd(1e-3 * scales_of(seen)));
    const std::int64_t m = filter.measured(sensor);
    const EstimatorBench::Step step = filter.motion_step(dt, start);
    const Eigen::MatrixXd h = filter.sensor_jacobian(sensor, start.mean);
    const Argument fresh = filter.start(start);
    const Eigen::VectorXd offset = filter.project_of(sensor, fresh).measurement;  // of the mean, which is 0

    Eigen::MatrixXd truth(filter.n, runs);
    Argument record = fresh;
    record.values.clear();
    for (int run = 0; run < runs; ++run) {
        truth.col(run) = sample.normal(start.mean, start.covariance);
        record.values.insert(record.values.end(), fresh.values.begin(), fresh.values.end());
    }
    Argument common = given("dt", Eigen::MatrixXd::Constant(1, 1, dt)), r = given("noise", noise);
    common.is_common = r.is_common = true;
    double nees = 0, nis = 0;
    ExecuteOptions fast;
    fast.is_guarded = false;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(filter.n), quiet = Eigen::VectorXd::Zero(m);
    for (int k = 0; k < steps; ++k) {
        HotCall call = filter.predict(common, record);
        record = EstimatorCalls::argument(call, execute_well(*instance, call, fast), 0, "record");
        const Argument measurement = input("measurement", m, 1, runs, [&](double* out, std::int64_t run) {
            truth.col(run) = step.transition * truth.col(run) + sample.normal(none, step.noise);
            Eigen::Map<Eigen::VectorXd>(out, m) = offset + h * truth.col(run) + sample.normal(quiet, noise);
        });
        call = filter.update(sensor, record, measurement, r);
        const Execution done = execute_well(*instance, call, fast);
        record = EstimatorCalls::argument(call, done, 0, "record");
        if (k != steps - 1) continue;
        const Argument innovation = EstimatorCalls::argument(call, done, 2, "innovation"),
                       spread = EstimatorCalls::argument(call, done, 3, "spread");
        const HotCall asking = filter.moments(record);
        const Execution told = execute_well(*instance, asking);
        const Argument mean = EstimatorCalls::argument(asking, told, 0, "mean"),
                       covariance = EstimatorCalls::argument(asking, told, 1, "covariance");
        for (int run = 0; run < runs; ++run) {
            nis += normalised(item(innovation, run).col(0), item(spread, run));
            nees += normalised(item(mean, run).col(0) - truth.col(run), item(covariance, run));
        }
    }
    // Of the last step, so that the runs' sums are independent: chi-square of runs x components degrees. The quantile 1e-6 is at
    // 4.75 deviations. A filter that forgets on purpose tells more than it is wrong: from below, half of the quantile is allowed.
    for (const auto& [name, sum, size] :
         {std::tuple("NEES", nees, static_cast<double>(filter.n)), std::tuple("NIS", nis, static_cast<double>(m))}) {
        const double degrees = runs * size;
        const double most = chi_square_quantile(degrees, 4.75) / runs,
                     least = 0.5 * chi_square_quantile(degrees, -4.75) / runs, mean = sum / runs;
        note(std::string(name) + " " + std::to_string(mean / size) + " a component");
        if (!(mean <= most && mean >= least))
            FAIL("after " << steps << " steps, over " << runs << " runs, the mean " << name << " is " << mean
                          << ", expected " << size << " (" << least << " to " << most << ")"
                          << (mean > most ? ": the filter is surer than it may be"
                                          : ": the filter is far less sure than it could be"));
    }
}

}  // namespace pelorus::conformance
