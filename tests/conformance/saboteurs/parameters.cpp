// Nearly constant velocity in three dimensions, with what may be wrong in what a plugin says of its parameters.
#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

enum class Form { white, wiener };

struct Saboteur : pelorus::KroneckerMotion<Saboteur, 2, 3> {
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD;
    double intensity = 1;
    std::optional<double> decay;
    Form form = Form::white;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A motion with a defect")
            .purpose(NEAR_MISS("description-is-complete") ? "Moves."
                                                          : "Nearly constant velocity, for the proof that the "
                                                            "conformance suites can fail.")
            .equation("F = [1 T; 0 1], Q = q [T^3/3 T^2/2; T^2/2 T]");
        if (!NEAR_MISS("description-is-complete"))  // "" where there is none
            plugin.source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "2001, equation 6.2.2-12");
        const bool is_far = DEFECT("defaults-are-read"), is_at_bound = NEAR_MISS("defaults-are-read");
        plugin.parameter("intensity", &Saboteur::intensity)
            .unit("m2/s3")
            .initially(is_far        ? "20000 m2/s3"
                       : is_at_bound ? "10000 m2/s3"
                                     : "1 m2/s3")
            .min(DEFECT("description-is-accepted")      ? 1e5
                 : NEAR_MISS("description-is-accepted") ? 1
                                                        : 0)
            .max(NEAR_MISS("description-is-accepted") ? 1 : 1e4)
            .doc(DEFECT("description-is-complete") ? "" : "spectral density of the acceleration");
        plugin.parameter("decay", &Saboteur::decay)
            .unit(DEFECT("units-are-read")      ? "1/sec"
                  : NEAR_MISS("units-are-read") ? "1/s"
                                                : "Hz")
            .doc("rate at which nothing decays");
        plugin.parameter("form", &Saboteur::form)
            .initially("white")
            .choices({{"white", "white acceleration"},
                      {DEFECT("values-can-be-written")      ? "null"
                       : NEAR_MISS("values-can-be-written") ? "off"
                                                            : "wiener",
                       "the same by another name"}})
            .doc("how the noise is called");
    }
    std::vector<double> priors() const { return {1e5, 100.0}; }
    Block transition(double dt) const { return (Block() << 1, dt, 0, 1).finished(); }
    Block noise_block(double dt) const {
        const double t = std::abs(dt);
        return intensity * (Block() << t * t * t / 3, dt * t / 2, dt * t / 2, t).finished();
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.motion.saboteur_of_parameters");
