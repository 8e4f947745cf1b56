// A good motion for saboteurs whose defects lie elsewhere: nearly constant velocity in three dimensions.
#pragma once

#include <cmath>
#include <vector>

#include <pelorus/pelorus.hpp>

template <class Derived> struct ConstantVelocity : pelorus::KroneckerMotion<Derived, 2, 3> {
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD;
    using Base = pelorus::KroneckerMotion<Derived, 2, 3>;
    using typename Base::Block;
    double intensity = 1;

    static pelorus::ParameterBuilder describe_as(pelorus::Describe<Derived>& plugin) {
        plugin.title("A motion with a defect")
            .purpose("Nearly constant velocity, for the proof that the conformance suites can fail.")
            .equation("F = [1 T; 0 1], Q = q [T^3/3 T^2/2; T^2/2 T]")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "2001, equation 6.2.2-12");
        return plugin.parameter("intensity", &ConstantVelocity::intensity)
            .unit("m2/s3")
            .initially("1 m2/s3")
            .min(0)
            .doc("spectral density of the acceleration");
    }
    std::vector<double> priors() const { return {1e5, 100.0}; }
    Block transition(double dt) const { return (Block() << 1, dt, 0, 1).finished(); }
    Block noise_block(double dt) const { return noise_of(dt, intensity); }
    static Block noise_of(double dt, double density) {
        const double t = std::abs(dt);
        return density * (Block() << t * t * t / 3, dt * t / 2, dt * t / 2, t).finished();
    }
};
