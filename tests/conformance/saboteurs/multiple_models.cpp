// The filter of estimator.imm, whose likelihood may be wrong.
#include <cmath>

#include "../../../plugins/estimator/imm/imm.cpp"
#include "../../../plugins/estimator/imm/imm_step.cpp"
#include "../../../plugins/estimator/imm/joined_space.cpp"
#include "defect.h"

namespace {

struct Saboteur : pelorus::Estimator<Saboteur> {
    using Filter = imm::Imm<true>;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("Multiple models with a defect")
            .purpose("Interacting multiple models, for the proof that the conformance suites can fail.")
            .equation("mu_j = c_j L_j / sum c_k L_k; the likelihood is sum c_k L_k")
            .source(
                "H. A. P. Blom, Y. Bar-Shalom, The interacting multiple model algorithm for systems with Markovian "
                "switching coefficients, IEEE Transactions on Automatic Control 33(8), 780-783, 1988");
        plugin.slot("estimators", "estimator", 1, -1, "a filter for each model, with the same sensors");
    }
    void setup(const pelorus::Setup& setup) {
        filter_.setup(setup);
        info = filter_.info;
        models_ = setup.parts<pelorus::EstimatorPart>("estimators").size();
    }
    const void* extension(const char*) const noexcept { return nullptr; }

    plr_status init(const plr_call& call, const plr_estimator_init& args) const { return filter_.init(call, args); }
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const {
        return filter_.predict(call, args);
    }
    plr_status project(const plr_call& call, const plr_estimator_project& args) const {
        return filter_.project(call, args);
    }
    plr_status update(const plr_call& call, const plr_estimator_update& args) const {
        const plr_status status = filter_.update(call, args);
        if (status < 0 || args.log_likelihood.data == nullptr) return status;
        double more = 0;
        if (DEFECT("estimator-equal-models-are-one"))
            more = std::log(static_cast<double>(models_));  // added, not weighed
        if (NEAR_MISS("estimator-equal-models-are-one")) more = 1e-11;
        for (std::int64_t i = 0; i < args.log_likelihood.count; ++i)
            args.log_likelihood.data[i * args.log_likelihood.item_stride] += more;
        return status;
    }
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const {
        return filter_.summary(call, args);
    }
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const {
        return filter_.moments(call, args);
    }
    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const {
        return filter_.assign(call, args);
    }

private:
    Filter filter_;
    std::size_t models_ = 1;
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.estimator.multiple_models");
