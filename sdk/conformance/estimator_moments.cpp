// The laws of an estimator's moments: how a track starts, what may be set, what mixtures are.
#include <cmath>

#include "estimator_bench.hpp"
#include "machine/bench.hpp"
#include "machine/check.hpp"

namespace pelorus::conformance {

namespace {

/// Fails unless the moments agree to `tolerance` of the deviations (of both) and the rounding of the means.
void same_moments(const std::string& what, const plr_space& space, const Gaussian& expected, const Gaussian& told,
                  double tolerance) {
    const Eigen::VectorXd scale = expected.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    for (Eigen::Index r = 0; r < scale.size(); ++r) {
        const double allowed = tolerance * scale(r) + 1e-12 * std::abs(expected.mean(r));
        if (!(std::abs(told.mean(r) - expected.mean(r)) <= allowed))
            FAIL(what << ": the mean of " << component_name(space, r) << " is " << told.mean(r) << ", expected "
                      << expected.mean(r));
        for (Eigen::Index k = 0; k <= r; ++k)
            if (!(std::abs(told.covariance(r, k) - expected.covariance(r, k)) <= tolerance * scale(r) * scale(k)))
                FAIL(what << ": covariance (" << component_name(space, r) << ", " << component_name(space, k) << ") is "
                          << told.covariance(r, k) << ", expected " << expected.covariance(r, k));
    }
}

bool state_is_cartesian(const EstimatorBench& filter) {
    if (filter.n != filter.c) return false;
    for (std::int64_t k = 0; k < filter.n; ++k)
        if (component_name(*filter.info.state, k) != component_name(*filter.info.cartesian, k)) return false;
    return true;
}

// What is copied or added up of a few terms is exact to some 1e-15; square roots that are multiplied out again, to their condition.
constexpr double rounding = 1e-9;

}  // namespace

PELORUS_CHECK(estimator, "estimator-unknown-starts-from-prior", 3,
              "A track starts with the moments that are given; components that are not enter with their declared prior "
              "mean and deviation, uncorrelated.",
              {"numbers-finite", "estimator-spaces-well-formed"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    if (!state_is_cartesian(filter)) skip("the state is not Cartesian: its priors are not those of the summary");
    if ((filter.info.flags & PLR_ESTIMATOR_ASSIGNABLE) == 0) skip("the filter is not one of two moments");
    Sample sample = bench.sample();
    const plr_space& space = *filter.info.cartesian;
    const Eigen::VectorXd full = sample.state(space);
    const Eigen::MatrixXd spread = sample.covariance(space);
    for (int attempt = 0; attempt < 4; ++attempt) {
        std::vector<std::int32_t> known;
        for (std::int32_t k = 0; k < filter.c; ++k) {
            const bool is_position = k < filter.axes;
            if (attempt == 0 ? is_position : attempt == 1 || k == 0 || sample.below(2) == 0) known.push_back(k);
        }
        Gaussian expected{Eigen::VectorXd(filter.c), Eigen::MatrixXd::Zero(filter.c, filter.c)};
        const auto* at = reinterpret_cast<const unsigned char*>(space.components);
        for (std::int64_t k = 0; k < filter.c; ++k) {
            const auto& component = *reinterpret_cast<const plr_component*>(at);
            at += space.components->struct_size;
            expected.mean(k) = component.prior_mean;
            expected.covariance(k, k) = component.prior_deviation * component.prior_deviation;
        }
        const auto count = static_cast<Eigen::Index>(known.size());
        Eigen::VectorXd mean(count);
        Eigen::MatrixXd covariance(count, count);
        for (Eigen::Index a = 0; a < count; ++a) {
            const std::int32_t r = known[static_cast<std::size_t>(a)];
            mean(a) = expected.mean(r) = full(r);
            for (Eigen::Index b = 0; b < count; ++b) {
                const std::int32_t k = known[static_cast<std::size_t>(b)];
                covariance(a, b) = expected.covariance(r, k) = spread(r, k);
            }
        }
        const Argument record = filter.run(filter.init(known, given("mean", mean), given("covariance", covariance)));
        same_moments("started with " + std::to_string(count) + " of " + std::to_string(filter.c) + " components", space,
                     expected, filter.moments_of(record), rounding);
    }
}

PELORUS_CHECK(estimator, "estimator-assign-sets-moments", 3,
              "assign gives a record the moments that it is told, and moments tells them; mixing would otherwise drift "
              "by itself.",
              {"numbers-finite", "estimator-assignable-as-declared"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    if (filter.table.assign == nullptr) skip("has no assign");
    Sample sample = bench.sample();
    const Argument tracks = filter.tracks(sample, 2);
    const Argument one = EstimatorBench::item_of(tracks, 0), other = EstimatorBench::item_of(tracks, 1);
    for (const Argument& from : {one, other}) {
        const Gaussian wanted = filter.moments_of(from);
        const Argument record =
            filter.run(filter.assign(one, given("mean", wanted.mean), given("covariance", wanted.covariance)));
        same_moments(&from == &one ? "assigned its own moments" : "assigned another track's moments",
                     *filter.info.state, wanted, filter.moments_of(record), rounding);
    }
}

PELORUS_CHECK(estimator, "estimator-summary-is-moments-in-cartesian", 3,
              "Where the state is Cartesian, summary and moments tell the same; what is published is what is filtered.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const EstimatorBench filter(*instance);
    if (!state_is_cartesian(filter)) skip("the state is not Cartesian");
    Sample sample = bench.sample();
    const Argument tracks = filter.tracks(sample, 4);
    for (std::int64_t i = 0; i < 4; ++i) {
        const Argument record = EstimatorBench::item_of(tracks, i);
        same_moments("summary, compared with moments", *filter.info.cartesian, filter.moments_of(record),
                     filter.summary_of(record), rounding);
    }
}

PELORUS_CHECK(estimator, "estimator-mixture-matches-moments", 3,
              "mix of a single hypothesis is that hypothesis; of several it has the mean and the covariance of the "
              "mixture, the spread of the means included.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    if (instance->extension<plr_estimator_mix>(PLR_ESTIMATOR_MIX) == nullptr) skip("does not offer " PLR_ESTIMATOR_MIX);
    const EstimatorBench filter(*instance);
    for (std::int64_t k = 0; k < filter.n; ++k) {
        const auto* const at = reinterpret_cast<const unsigned char*>(filter.info.state->components) +
                               static_cast<std::size_t>(k) * filter.info.state->components->struct_size;
        if ((reinterpret_cast<const plr_component*>(at)->flags & PLR_COMPONENT_ANGLE) != 0)
            skip("the state has angles: their mean is a matter of definition");
    }
    Sample sample = bench.sample();
    const Argument tracks = filter.tracks(sample, 3);
    std::vector<Gaussian> parts;
    for (std::int64_t k = 0; k < 3; ++k) parts.push_back(filter.moments_of(EstimatorBench::item_of(tracks, k)));
    Argument records = tracks;
    records.name = "records";
    records.cols = 3;
    const double w = sample.uniform(0.2, 0.4);
    for (const Eigen::Vector3d& weights :
         {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(w, 0.9 - w, 0.1)}) {
        Gaussian expected{Eigen::VectorXd::Zero(filter.n), Eigen::MatrixXd::Zero(filter.n, filter.n)};
        for (std::size_t k = 0; k < 3; ++k) expected.mean += weights(static_cast<Eigen::Index>(k)) * parts[k].mean;
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::VectorXd apart = parts[k].mean - expected.mean;
            expected.covariance +=
                weights(static_cast<Eigen::Index>(k)) * (parts[k].covariance + apart * apart.transpose());
        }
        const Gaussian mixed = filter.moments_of(filter.run(filter.mix(given("weights", weights), records)));
        std::ostringstream what;
        what << "mixed with weights " << weights.transpose();
        same_moments(what.str(), *filter.info.state, expected, mixed, rounding);
    }
}

PELORUS_CHECK(estimator, "estimator-mode-probabilities", 3,
              "The probabilities of the modes are from 0 to 1 and sum to 1; analyzers and mixers take them for such.",
              {"numbers-finite"}) {
    const auto instance = bench.make();
    const auto* const modes = instance->extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES);
    if (modes == nullptr) skip("does not offer " PLR_ESTIMATOR_MODES);
    if (modes->mode_count < 1 || modes->names == nullptr) FAIL("modes without a mode or without names");
    for (std::int32_t k = 0; k < modes->mode_count; ++k)
        if (modes->names[k] == nullptr || modes->names[k][0] == 0) FAIL("mode " << k << " has no name");
    const EstimatorBench filter(*instance);
    Sample sample = bench.sample();
    const HotCall call = filter.probabilities(filter.tracks(sample, 5));
    const Execution done = execute_well(*instance, call);
    for (std::int64_t i = 0; i < call.count; ++i) {
        double sum = 0;
        for (const double p : HotCall::item_of(call.out[0], done.out[0], i)) {
            if (!(p >= 0 && p <= 1 + 1e-12)) FAIL("a mode of item " << i << " has the probability " << p);
            sum += p;
        }
        if (!(std::abs(sum - 1) <= 1e-9)) FAIL("the probabilities of item " << i << " sum to " << sum);
    }
}

}  // namespace pelorus::conformance
