// Nearly constant velocity on three axes (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and
// Navigation, 2001, equations 6.2.2-4 and 6.2.2-12): linear, time-invariant, exact.
#include <pelorus/motion.hpp>

#include "reference_parts.hpp"

namespace pelorus::conformance {

namespace {

struct Motion : KroneckerMotion<Motion, 2, 3> {
    static constexpr std::uint32_t flags =
        PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT | PLR_MOTION_EXACT_NOISE;
    double intensity = 1;  // m2/s3

    static void describe(Describe<Motion>& plugin) {
        plugin.title("Nearly constant velocity, three axes");
        plugin.parameter("intensity", &Motion::intensity)
            .unit("m2/s3")
            .initially("1 m2/s3")
            .min(0)
            .doc("spectral density of the acceleration");
    }
    std::vector<double> priors() const { return {1e5, 100.0}; }
    Block transition(double dt) const { return (Block() << 1, dt, 0, 1).finished(); }
    Block noise_block(double dt) const {
        return intensity * (Block() << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt).finished();
    }
};

}  // namespace

const plr_plugin* reference_motion() {
    return pelorus::detail::plugin<Motion>("pelorus.conformance.motion", "pelorus.conformance.motion");
}

}  // namespace pelorus::conformance
