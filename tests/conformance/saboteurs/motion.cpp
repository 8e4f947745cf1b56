// Nearly constant velocity in three dimensions, with what a motion may do wrong.
#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

struct Saboteur : pelorus::KroneckerMotion<Saboteur, 2, 3> {
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD;
    using Base = pelorus::KroneckerMotion<Saboteur, 2, 3>;
    double intensity = 1;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A motion with a defect")
            .purpose("Nearly constant velocity, for the proof that the conformance suites can fail.")
            .equation("F = [1 T; 0 1], Q = q [T^3/3 T^2/2; T^2/2 T]")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "2001, equation 6.2.2-12");
        plugin.parameter("intensity", &Saboteur::intensity)
            .unit("m2/s3")
            .initially("1 m2/s3")
            .min(0)
            .doc("spectral density of the acceleration");
    }
    std::vector<double> priors() const { return {1e5, 100.0}; }
    Block transition(double dt) const { return (Block() << 1, dt, 0, 1).finished(); }
    Block noise_block(double dt) const {
        const double t = std::abs(dt);
        return intensity * (Block() << t * t * t / 3, dt * t / 2, dt * t / 2, t).finished();
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        Transition q = Base::noise(posterior, step);
        if (DEFECT("covariances-symmetric-positive")) q(3, 0) *= 1 + 1e-12;
        if (NEAR_MISS("covariances-symmetric-positive")) q(3, 0) = q(0, 3) = q(3, 0) * (1 + 1e-12);
        return q;
    }
    Transition jacobian(const State& x, const pelorus::Step& step) const { return Base::jacobian(x, step); }
    const void* extension(const char*) const noexcept { return nullptr; }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.motion.saboteur");
