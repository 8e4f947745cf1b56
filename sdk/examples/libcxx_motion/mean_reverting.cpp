// org.example.motion.mean_reverting: motion whose velocity fades and is disturbed, an integrated Ornstein-Uhlenbeck process.
//
// A model that acts alike on every axis gives the matrices of one axis; the SDK makes the full ones of them.
#include <cmath>

#include <pelorus/pelorus.hpp>

namespace {

/// The position's share of the noise, (a - 2 (1 - e^-a) + (1 - e^-2a)/2) / a^3: 1/3 at a = 0.
double position_share(double a) {
    if (a > 0.5) return (a + 2 * std::expm1(-a) - std::expm1(-2 * a) / 2) / (a * a * a);
    double sum = 0, term = -1.0 / 6;  // (-1)^k / k! a^(k - 3), from k = 3 on
    for (int k = 3; k < 24; ++k) {
        sum += term * (2 - std::ldexp(1.0, k - 1));
        term *= -a / (k + 1);
    }
    return sum;
}

/// (1 - e^-a) / a: 1 at a = 0.
double fading_mean(double a) { return a == 0 ? 1.0 : -std::expm1(-a) / a; }

struct MeanReverting : pelorus::KroneckerMotion<MeanReverting, 2, 3> {
    static constexpr std::uint32_t flags =
        PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT | PLR_MOTION_EXACT_NOISE;

    double rate = 0, density = 0;                   // 1/s, m2/s3
    double prior_position = 0, prior_velocity = 0;  // m, m/s

    static void describe(pelorus::Describe<MeanReverting>& plugin) {
        plugin.title("Velocity that reverts to zero")
            .purpose(
                "Motion whose velocity fades at a rate and is disturbed all the time, so that it stays within sqrt(q / "
                "2 "
                "K): people, ships in a harbour, whatever does not fly straight on for ever.")
            .equation(
                "v' = e^-KT v; p' = p + (1 - e^-KT)/K v; Q = integral of q G G' over the step, "
                "G = [(1 - e^-Ks)/K; e^-Ks]")
            .source(
                "G. E. Uhlenbeck, L. S. Ornstein, On the theory of the Brownian motion, Physical Review 36, 823-841, "
                "1930");
        plugin.parameter("rate", &MeanReverting::rate)
            .unit("1/s")
            .initially("0.05 1/s")
            .min(0.0)
            .max(1000.0)
            .doc("K: the velocity fades by e^-KT; 0: not at all, which is motion at constant velocity");
        plugin.parameter("noise", &MeanReverting::density)
            .unit("m2/s3")
            .initially("1 m2/s3")
            .min(0.0)
            .doc("q: spectral density of the disturbing acceleration");
        plugin.parameter("prior_position", &MeanReverting::prior_position)
            .unit("m")
            .initially("1000 km")
            .above(0.0)
            .doc("deviation of a position component that nothing is known of");
        plugin.parameter("prior_velocity", &MeanReverting::prior_velocity)
            .unit("m/s")
            .initially("20 m/s")
            .above(0.0)
            .doc("deviation of a velocity component that nothing is known of");
    }

    // Refused here, inside the library: the exception is thrown and caught with libc++abi, the host gets a status and a text.
    void setup(const pelorus::Setup&) {
        if (rate == 0 && density == 0)
            throw pelorus::ParameterError("noise", "is 0, and so is rate: the velocity could never change");
    }

    std::vector<double> priors() const { return {prior_position, prior_velocity}; }

    Block transition(double dt) const {
        Block f;
        f << 1, dt * fading_mean(rate * dt), 0, std::exp(-rate * dt);
        return f;
    }
    Block noise_block(double dt) const {
        const double a = rate * dt, mean = fading_mean(a);
        Block q;
        q(0, 0) = density * dt * dt * dt * position_share(a);
        q(0, 1) = q(1, 0) = density * dt * dt * mean * mean / 2;
        q(1, 1) = density * dt * fading_mean(2 * a);
        return q;
    }
};

}  // namespace

PELORUS_PLUGIN(MeanReverting, "org.example.motion.mean_reverting");
