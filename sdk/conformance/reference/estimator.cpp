// The Kalman filter, for trackers that are tried without another.
#include "kalman_filter.hpp"
#include "reference_parts.hpp"

namespace pelorus::conformance {

namespace {

struct Estimator : KalmanFilter<Estimator> {
    static void describe(Describe<Estimator>& plugin) {
        plugin.title("Kalman filter, Joseph's form");
        describe_slots(plugin);
    }
};

}  // namespace

const plr_plugin* reference_estimator() {
    return pelorus::detail::plugin<Estimator>("pelorus.conformance.estimator", "pelorus.conformance.estimator");
}

}  // namespace pelorus::conformance
