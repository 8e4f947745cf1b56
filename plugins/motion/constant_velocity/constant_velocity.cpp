// motion.constant_velocity: straight flight at a speed that white acceleration disturbs. See README.md.
#include "constant_velocity_model.hpp"

#include <optional>

#include <pelorus/axis_motion.hpp>

namespace {

using namespace constant_velocity;

enum class Form { continuous, discrete };

struct Parameters {
    int dimension = 3;
    Form form = Form::continuous;
    std::optional<std::vector<double>> density;    // m2/s3
    std::optional<std::vector<double>> deviation;  // m/s2
    std::optional<double> acceleration_deviation;  // m/s2
    double prior_position = 0.0, prior_velocity = 0.0;

    /// Variance (discrete) or spectral density (continuous) on each axis. Throws ParameterError for the other form's parameter.
    template <int D> Vector<D> intensities() const {
        const bool discrete = form == Form::discrete;
        if (discrete ? density : deviation)
            throw pelorus::ParameterError(discrete ? "noise" : "acceleration",
                                          discrete ? "belongs to form: continuous; form: discrete takes acceleration"
                                                   : "belongs to form: discrete; form: continuous takes noise");
        if (discrete)
            return pelorus::per_axis<D>("acceleration", deviation.value_or(std::vector<double>{1.0})).cwiseAbs2();
        return pelorus::per_axis<D>("noise", density.value_or(std::vector<double>{1.0}));
    }
};

template <Form form> Matrix<2> axis_noise(double dt) {
    if constexpr (form == Form::continuous) return continuous_noise(dt);
    const Vector<2> g = discrete_factor(dt);
    return g * g.transpose();
}

/// Positions and velocities.
template <int D, Form form_> struct Model : pelorus::AxisMotion<Model<D, form_>, 2, D>, Parameters {
    static constexpr bool rank_one = form_ == Form::discrete;
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           PLR_MOTION_BACKWARD |
                                           (rank_one ? 0u : std::uint32_t{PLR_MOTION_EXACT_NOISE});

    static void describe(pelorus::Describe<Model>& plugin) { describe_all(plugin); }
    void setup(const pelorus::Setup&) { this->intensity = intensities<D>(); }
    Matrix<2> transition(double dt) const { return constant_velocity::transition(dt); }
    Vector<2> unit_factor(double dt) const { return discrete_factor(dt); }
    Matrix<2> unit_noise(double dt) const { return axis_noise<form_>(dt); }
    std::vector<double> priors() const { return {prior_position, prior_velocity}; }
};

/// The same with accelerations beside them, which move nothing and which each step draws anew. Such a step cannot be taken back.
template <int D, Form form_>
struct WithAcceleration : pelorus::KroneckerMotion<WithAcceleration<D, form_>, 3, D>, Parameters {
    using Base = pelorus::KroneckerMotion<WithAcceleration<D, form_>, 3, D>;
    using typename Base::Posterior;
    using typename Base::Transition;
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_TIME_INVARIANT |
                                           (form_ == Form::discrete ? 0u : std::uint32_t{PLR_MOTION_EXACT_NOISE});

    static void describe(pelorus::Describe<WithAcceleration>& plugin) { describe_all(plugin); }
    void setup(const pelorus::Setup&) { intensity = intensities<D>(); }

    Matrix<3> transition(double dt) const {
        if (dt == 0.0) return Matrix<3>::Identity();  // no step, nothing is drawn anew
        Matrix<3> f = Matrix<3>::Zero();
        f.topLeftCorner<2, 2>() = constant_velocity::transition(dt);
        return f;
    }
    Matrix<3> noise_block(double dt) const { return moving_noise(dt) * intensity(0) + drawn_noise(dt); }
    Transition noise(const Posterior&, const pelorus::Step& step) const {
        return pelorus::on_axes<3, D>(moving_noise(step.dt), intensity) +
               pelorus::on_axes<3, D>(drawn_noise(step.dt), Vector<D>(Vector<D>::Ones()));
    }
    /// A column an axis for the motion, another one for the acceleration; discrete form only.
    Matrix<3 * D, 2 * D> noise_factor(const Posterior&, const pelorus::Step& step) const {
        const Vector<2> g = discrete_factor(step.dt);
        Matrix<3 * D, 2 * D> factor;
        factor << pelorus::column_on_axes<3, D>(Vector<3>(g(0), g(1), 0.0), Vector<D>(intensity.cwiseSqrt())),
            pelorus::column_on_axes<3, D>(Vector<3>(0.0, 0.0, std::sqrt(drawn_noise(step.dt)(2, 2))),
                                          Vector<D>(Vector<D>::Ones()));
        return factor;
    }
    const void* extension(const char* id) const noexcept {
        if (std::strcmp(id, PLR_MOTION_STRUCTURE) == 0 && intensity != Vector<D>::Constant(intensity(0)))
            return nullptr;
        if constexpr (form_ == Form::discrete)
            if (std::strcmp(id, PLR_MOTION_NOISE_FACTOR) == 0)
                return pelorus::noise_factor_extension<WithAcceleration, 2 * D>();
        return Base::extension(id);
    }
    std::vector<double> priors() const { return {prior_position, prior_velocity, *acceleration_deviation}; }

    Vector<D> intensity = Vector<D>::Ones();

private:
    static Matrix<3> moving_noise(double dt) {
        Matrix<3> q = Matrix<3>::Zero();
        q.topLeftCorner<2, 2>() = axis_noise<form_>(dt);
        return q;
    }
    Matrix<3> drawn_noise(double dt) const {
        Matrix<3> q = Matrix<3>::Zero();
        q(2, 2) = dt == 0.0 ? 0.0 : *acceleration_deviation * *acceleration_deviation;
        return q;
    }
};

template <class Class> void describe_all(pelorus::Describe<Class>& plugin) {
    plugin.title("Nearly constant velocity")
        .purpose(
            "Straight motion whose velocity is disturbed by white acceleration, on one to three axes alike. The first "
            "choice for targets that seldom manoeuvre.")
        .equation(
            "x = (p, v); F = [1 T; 0 1] on each axis. continuous: Q = q [T^3/3 T^2/2; T^2/2 T]. discrete: Q = s^2 g "
            "g', g = [T^2/2; T]. dt < 0: F(dt) Q(-dt) F(dt)'. With acceleration_deviation b: x = (p, v, a); a has a "
            "row and a column of 0 in F and the variance b^2 in Q")
        .source(
            "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, Wiley "
            "2001, 6.2.2 and 6.3.2");
    plugin.parameter("dimension", &Parameters::dimension).initially("3").min(1).max(3).doc("number of axes: x, y, z");
    plugin.parameter("form", &Parameters::form)
        .initially("continuous")
        .choices({{"continuous", "white acceleration; takes noise, and steps of any length agree with each other"},
                  {"discrete", "an acceleration that is constant over each step; takes acceleration"}})
        .doc("how the disturbing acceleration is modelled");
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s3")
        .min(0.0)
        .rows(1, 3)
        .doc(
            "spectral density of the acceleration, one value or one an axis; form continuous only, there 1 m2/s3 if "
            "absent");
    plugin.parameter("acceleration", &Parameters::deviation)
        .unit("m/s2")
        .min(0.0)
        .rows(1, 3)
        .doc("deviation of the acceleration, one value or one an axis; form discrete only, there 1 m/s2 if absent");
    plugin.parameter("acceleration_deviation", &Parameters::acceleration_deviation)
        .unit("m/s2")
        .above(0.0)
        .doc(
            "if given, the state holds accelerations as well, so that it has the components of models with "
            "accelerations; each step replaces them by ones of mean 0 and this deviation. Forward in time only");
    pelorus::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity);
}

template <int D> using Continuous = Model<D, Form::continuous>;
template <int D> using Discrete = Model<D, Form::discrete>;
template <int D> using ContinuousWithAcceleration = WithAcceleration<D, Form::continuous>;
template <int D> using DiscreteWithAcceleration = WithAcceleration<D, Form::discrete>;

/// Chooses the class by form, components and dimension.
struct ConstantVelocity : pelorus::ByDimension<Continuous> {
    static plr_instance create(const pelorus::Setup& setup) {
        Continuous<3> chosen;
        pelorus::Describe<Continuous<3>>::of().bind(chosen, setup.raw());
        const bool continuous = chosen.form == Form::continuous;
        if (chosen.acceleration_deviation)
            return continuous ? pelorus::ByDimension<ContinuousWithAcceleration>::create(setup)
                              : pelorus::ByDimension<DiscreteWithAcceleration>::create(setup);
        return continuous ? pelorus::ByDimension<Continuous>::create(setup)
                          : pelorus::ByDimension<Discrete>::create(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(ConstantVelocity, "motion.constant_velocity");
