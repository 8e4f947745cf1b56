// The smoother of estimator.fixed_lag_smoother, which may be wrong about the past.
#include "../../../plugins/estimator/fixed_lag_smoother/fixed_lag_smoother.cpp"
#include "../../../plugins/estimator/fixed_lag_smoother/smoothing.cpp"
#include "defect.h"

namespace {

struct Saboteur : pelorus::Estimator<Saboteur> {
    static constexpr bool assignable = false;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A smoother with a defect")
            .purpose("Tells of times past, for the proof that the conformance suites can fail.")
            .equation("x_k|K = x_k + C_k (x_(k+1)|K - x_(k+1|k)), P_k|K = D_k + C_k P_(k+1)|K C_k'")
            .source(
                "H. E. Rauch, F. Tung, C. T. Striebel, Maximum likelihood estimates of linear dynamic systems, AIAA "
                "Journal 3(8), 1445-1450, 1965");
        plugin.slot("estimator", "estimator", 1, 1, "the filter");
        plugin.slot("motion", "motion", 1, 1, "the filter's motion");
    }
    void setup(const pelorus::Setup& setup) {
        filter_.setup(setup);
        info = filter_.info;
        inner_ = static_cast<const plr_estimator_smoothed*>(filter_.extension(PLR_ESTIMATOR_SMOOTHED));
        smoothed_ = *inner_;
        smoothed_.smoothed = &Saboteur::smoothed;
    }
    const void* extension(const char* id) const noexcept {
        return filter_.extension(id) == nullptr ? nullptr : &smoothed_;
    }

    plr_status init(const plr_call& call, const plr_estimator_init& args) const { return filter_.init(call, args); }
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const {
        return filter_.predict(call, args);
    }
    plr_status project(const plr_call& call, const plr_estimator_project& args) const {
        return filter_.project(call, args);
    }
    plr_status update(const plr_call& call, const plr_estimator_update& args) const {
        return filter_.update(call, args);
    }
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const {
        return filter_.summary(call, args);
    }
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const {
        return filter_.moments(call, args);
    }

private:
    static plr_status smoothed(const void* self, const plr_call* call,
                               const plr_estimator_smoothed_args* args) noexcept {
        const auto& own = *static_cast<const Saboteur*>(self);
        const plr_status status = own.inner_->smoothed(&own.filter_, call, args);
        if (status < 0 || args->covariance.data == nullptr) return status;
        const std::int64_t c = args->covariance.rows, size = c * args->covariance.cols;
        double factor = 1;
        if (DEFECT("estimator-smoothed-improves-on-filtered")) factor = 100;  // deviations ten times as large
        if (NEAR_MISS("estimator-smoothed-improves-on-filtered")) factor = 1 + 1e-12;
        for (std::int64_t i = 0; i < args->covariance.count; ++i)
            for (std::int64_t k = c * c; k < size; ++k)
                args->covariance.data[i * args->covariance.item_stride + k] *= factor;
        return status;
    }

    fixed_lag_smoother::FixedLagSmoother filter_;
    const plr_estimator_smoothed* inner_ = nullptr;
    plr_estimator_smoothed smoothed_{};
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.estimator.smoother");
