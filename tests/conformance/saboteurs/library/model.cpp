// Two good motions (nearly constant velocity in three dimensions), for libraries that have a defect of their own: see library.c.
#include <pelorus/pelorus.hpp>

namespace {

template <int Which> struct Model : pelorus::KroneckerMotion<Model<Which>, 2, 3> {
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_EXACT_NOISE | PLR_MOTION_BACKWARD;
    using Block = typename pelorus::KroneckerMotion<Model<Which>, 2, 3>::Block;
    double intensity = 1;

    static void describe(pelorus::Describe<Model>& plugin) {
        plugin.title("A motion in a library with a defect")
            .purpose("Nearly constant velocity, for the proof that the conformance suites can fail.")
            .equation("F = [1 T; 0 1], Q = q [T^3/3 T^2/2; T^2/2 T]")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "2001, equation 6.2.2-12");
        plugin.parameter("intensity", &Model::intensity)
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
};

}  // namespace

extern "C" {
const plr_plugin* saboteur_plugin(const char* wanted) noexcept;
const plr_plugin* other_saboteur_plugin(const char* id, const char* wanted) noexcept;
}

/// The plugin of the id that the whole file library.c is about, or NULL.
const plr_plugin* saboteur_plugin(const char* wanted) noexcept {
    return pelorus::detail::plugin<Model<1>>("org.example.motion.saboteur", wanted);
}

/// Another one under an id that the caller chooses.
const plr_plugin* other_saboteur_plugin(const char* id, const char* wanted) noexcept {
    return pelorus::detail::plugin<Model<2>>(id, wanted);
}
