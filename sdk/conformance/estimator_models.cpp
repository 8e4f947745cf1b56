// The laws of filters over several models.
#include <cmath>

#include "estimator_bench.hpp"
#include "machine/bench.hpp"
#include "machine/check.hpp"
#include "machine/library.hpp"

namespace pelorus::conformance {

namespace {

/// The slot for models that takes several of them, or nullptr.
const plr_slot* slot_of_models(const plr_description& description) {
    const auto* at = reinterpret_cast<const unsigned char*>(description.slots);
    for (std::uint32_t s = 0; s < description.slot_count; ++s) {
        const auto& slot = *reinterpret_cast<const plr_slot*>(at);
        at += slot.struct_size;
        const std::string kind = slot.kind;
        if ((kind == "motion" || kind == "estimator") && (slot.max < 0 || slot.max >= 2)) return &slot;
    }
    return nullptr;
}

/// The subject with that many parts in the slot, all like the first that it has there, or like the suites' own.
Node with_equal_models(const Node& subject, const plr_slot& slot, int count) {
    Node model;
    model.use = reference_part(slot.kind)->description->id;
    Node made = subject;
    made.parts.clear();
    bool is_found = false;
    for (const Node& part : subject.parts) {
        if (part.slot != slot.name) {
            made.parts.push_back(part);
        } else if (!is_found) {
            model = part;
            is_found = true;
        }
    }
    model.slot = slot.name;
    for (int k = 0; k < count; ++k) {
        model.name = "model_" + std::to_string(k + 1);
        made.parts.push_back(model);
    }
    return made;
}

/// Sums and products of a few dozen terms, in another order; square roots lose to their condition (some 1e4 here).
constexpr double rounding = 1e-8;

void same_moments(const std::string& when, const EstimatorBench& filter, const Gaussian& several,
                  const Gaussian& single) {
    const Eigen::VectorXd scale = single.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    for (Eigen::Index r = 0; r < scale.size(); ++r) {
        if (!(std::abs(several.mean(r) - single.mean(r)) <= rounding * scale(r) + 1e-12 * std::abs(single.mean(r))))
            FAIL(when << "the mean of " << filter.state_name(r) << " is " << several.mean(r)
                      << " with two equal models, " << single.mean(r) << " with one");
        for (Eigen::Index k = 0; k <= r; ++k)
            if (!(std::abs(several.covariance(r, k) - single.covariance(r, k)) <= rounding * scale(r) * scale(k)))
                FAIL(when << "covariance (" << filter.state_name(r) << ", " << filter.state_name(k) << ") is "
                          << several.covariance(r, k) << " with two equal models, " << single.covariance(r, k)
                          << " with one");
    }
}

}  // namespace

PELORUS_CHECK(estimator, "estimator-equal-models-are-one", 3,
              "A filter over two equal models is the filter over one: the same moments, the same likelihood. What "
              "differs comes from the mixing: a spread counted twice, likelihoods added without their weights.",
              {"numbers-finite", "estimator-spaces-well-formed"}) {
    const plr_slot* const slot = slot_of_models(bench.description());
    if (slot == nullptr) skip("takes a single model");
    const auto instance = [&](int count) {
        return std::make_unique<Instance>(bench.host(), bench.plugin(),
                                          with_equal_models(bench.subject().node, *slot, count), Surroundings{});
    };
    const auto one = instance(1), two = instance(2);
    const EstimatorBench single(*one), several(*two);
    if (several.n != single.n)
        FAIL("with two equal models the state has " << several.n << " components, with one " << single.n);
    Sample sample = bench.sample();
    const plr_space& space = *single.info.cartesian;
    const Gaussian start{sample.state(space), sample.covariance(space)};
    Argument alone = single.start(start), together = several.start(start);
    for (int k = 0; k < 6; ++k) {
        const double dt = sample.uniform(0.05, 2.0);
        alone = single.step(alone, dt);
        together = several.step(together, dt);
        same_moments("predicted " + std::to_string(k + 1) + " times: ", single, several.moments_of(together),
                     single.moments_of(alone));
        const Measured measured = measured_near(single, 0, alone, sample);
        const Eigen::VectorXd z = item(measured.measurement, 0).col(0);
        const Eigen::MatrixXd noise = item(measured.noise, 0);
        const auto seen = single.update_of(0, alone, z, noise), mixed = several.update_of(0, together, z, noise);
        alone = seen.record;
        together = mixed.record;
        same_moments("updated " + std::to_string(k + 1) + " times: ", single, several.moments_of(together),
                     single.moments_of(alone));
        if (!(std::abs(mixed.log_likelihood - seen.log_likelihood) <= rounding * (1 + std::abs(seen.log_likelihood))))
            FAIL("updated " << k + 1 << " times: log_likelihood is " << mixed.log_likelihood
                            << " with two equal models, " << seen.log_likelihood << " with one");
    }
}

}  // namespace pelorus::conformance
