// motion.adaptive_constant_acceleration: constant acceleration whose noise follows the posterior covariance. See README.md.
#include "../../common/axis_models/acceleration_model.hpp"
#include "../../common/axis_models/constant_acceleration.hpp"

namespace {

using namespace axis_models;

enum class NoiseForm { piecewise, white_jerk };

struct Parameters : AccelerationParameters {
    NoiseForm noise_form = NoiseForm::piecewise;
};

template <int D> struct Model : pelorus::Motion<Model<D>, 3 * D>, Parameters {
    using Base = pelorus::Motion<Model<D>, 3 * D>;
    using typename Base::Posterior;
    using typename Base::State;
    using typename Base::Transition;
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_TIME_INVARIANT;
    static constexpr int record_size = D;  // variance of the velocity on each axis, of the posterior before the last

    static void describe(pelorus::Describe<Model>& plugin);

    pelorus::Space space() const { return pelorus::kinematic_space(D, priors()); }
    State propagate(const State& x, const pelorus::Step& step) const {
        return moved<D>(constant_acceleration::transition(step.dt), x);
    }
    Transition jacobian(const State&, const pelorus::Step& step) const {
        return pelorus::on_axes<3, D>(constant_acceleration::transition(step.dt), Vector<D>(Vector<D>::Ones()));
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        return pelorus::on_axes<3, D>(unit_noise(step.dt), weights(posterior, step));
    }
    Matrix<3 * D, D> noise_factor(const Posterior& posterior, const pelorus::Step& step) const {
        return pelorus::column_on_axes<3, D>(constant_acceleration::discrete_factor(step.dt),
                                             Vector<D>(weights(posterior, step).cwiseSqrt()));
    }
    const void* extension(const char* id) const noexcept {
        if (noise_form == NoiseForm::piecewise && std::strcmp(id, PLR_MOTION_NOISE_FACTOR) == 0)
            return pelorus::noise_factor_extension<Model, D>();
        return Base::extension(id);
    }

    Vector<D> init_record(const State&, const Transition& covariance) const { return velocity_variances(covariance); }
    Vector<D> advance_record(const State&, const Transition& covariance, const pelorus::Step&) const {
        return velocity_variances(covariance);
    }

private:
    static Vector<D> velocity_variances(const Transition& covariance) {
        return covariance.diagonal().template segment<D>(D);
    }
    Matrix<3> unit_noise(double dt) const {
        if (noise_form == NoiseForm::white_jerk) return constant_acceleration::continuous_noise(dt);
        const Vector<3> g = constant_acceleration::discrete_factor(dt);
        return g * g.transpose();
    }
    /// T^2 s^2, multiplied out so that no short step divides by T; nothing is added to a state that stands still.
    static Vector<D> weights(const Posterior& posterior, const pelorus::Step& step) {
        const Transition& p = posterior.covariance;
        const double dt = step.dt;
        Vector<D> weights = Vector<D>::Zero();
        if (dt == 0.0) return weights;
        for (int axis = 0; axis < D; ++axis) {
            const int v = D + axis, a = 2 * D + axis;
            const double spread = 4.0 * dt * dt * p(a, a) - 4.0 * dt * p(v, a) + p(v, v) + step.record[axis];
            weights(axis) = rayleigh_ratio * std::max(spread, 0.0);
        }
        return weights;
    }
};

template <int D> void Model<D>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Adaptive constant acceleration")
        .purpose(
            "Constant acceleration whose process noise is in proportion to the posterior covariance: the change of the "
            "acceleration that the last two estimates of the velocity allow. It has no intensity to tune.")
        .equation(
            "x = (p, v, a); F = [1 T T^2/2; 0 1 T; 0 0 1] on each axis; Q = T^2 s^2 q, s^2 = (4 - pi)/pi max(0, 4 P_aa "
            "- 4 P_va/T + (P_vv,k + P_vv,k-1)/T^2) of that axis' posterior; q = g g' with g = [T^2/2; T; 1], or "
            "[T^5/20 T^4/8 T^3/6; T^4/8 T^3/3 T^2/2; T^3/6 T^2/2 T]")
        .source(
            "H. Zhang, J. Xie, J. Ge, B. Zong, W. Lu, Maneuvering target tracking based on waveform scheduling, Acta "
            "Electronica Sinica 47(3), 560-567, 2019; eq. 12 with "
            "the variance of the acceleration, as its derivation needs, in place of a velocity's");
    describe_dimension(plugin);
    plugin.parameter("noise_form", &Parameters::noise_form)
        .initially("piecewise")
        .choices({{"piecewise", "the acceleration changes at the start of each step and then holds"},
                  {"white_jerk", "the acceleration changes all along the step"}})
        .doc("how the change of the acceleration acts within a step");
    describe_priors(plugin);
}

}  // namespace

PELORUS_PLUGIN(pelorus::ByDimension<Model>, "motion.adaptive_constant_acceleration");
