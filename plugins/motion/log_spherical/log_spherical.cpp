// motion.log_spherical: constant velocity in logarithmic spherical or polar coordinates. See README.md.
#include "log_spherical_model.hpp"

#include "../../common/kinematics/white_acceleration.hpp"

#include <pelorus/axis_motion.hpp>

namespace {

struct Parameters {
    int dimension = 3;
    double density = 0.0;  // m2/s3
    double mean_range = 0.0, prior_log_range = 0.0, prior_angle = 0.0, prior_rate = 0.0;
    double prior_position = 0.0, prior_velocity = 0.0;
};

template <int D> struct Model : pelorus::Motion<Model<D>, 2 * D>, Parameters {
    static constexpr int size = 2 * D;
    using Base = pelorus::Motion<Model<D>, size>;
    using typename Base::Cartesian;
    using typename Base::Posterior;
    using typename Base::State;
    using typename Base::Transition;
    static constexpr std::uint32_t flags = PLR_MOTION_TIME_INVARIANT | PLR_MOTION_BACKWARD;
    static constexpr bool cartesian = false;

    static void describe(pelorus::Describe<Model>& plugin);

    pelorus::Space space() const {
        const pelorus::Component log_range{"log_range", "", std::log(mean_range), prior_log_range, false},
            azimuth{"azimuth", "rad", 0.0, prior_angle, true}, elevation{"elevation", "rad", 0.0, prior_angle, true},
            growth{"range_rate_over_range", "1/s", 0.0, prior_rate, false},
            across{D == 2 ? "azimuth_rate" : "cross_rate", "rad/s", 0.0, prior_rate, false},
            up{"elevation_rate", "rad/s", 0.0, prior_rate, false};
        if (D == 2) return pelorus::Space({log_range, azimuth, growth, across});
        return pelorus::Space({log_range, azimuth, elevation, growth, across, up});
    }
    pelorus::Space cartesian_space() const { return pelorus::kinematic_space(D, {prior_position, prior_velocity}); }

    State propagate(const State& x, const pelorus::Step& step) const {
        return flat(log_spherical::propagate(full(x), step.dt));
    }
    Transition jacobian(const State& x, const pelorus::Step& step) const {
        const pelorus::Vector<6> s = full(x);
        return flat(log_spherical::jacobian(s, log_spherical::propagate(s, step.dt), step.dt));
    }
    /// Of Cartesian white acceleration, carried to the coordinates at the predicted state.
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        Transition q = Transition::Zero(), out;
        kinematics::add_per_axis<D>(kinematics::white_acceleration(step.dt),
                                    pelorus::Vector<D>(pelorus::Vector<D>::Constant(density)), q);
        if (step.dt < 0) {
            Transition back = Transition::Identity();
            back.template topRightCorner<D, D>().diagonal().setConstant(step.dt);
            q = kinematics::carried_back<size>(back, q);
        }
        pelorus::small::symmetric_product(flat(log_spherical::from_cartesian_jacobian(full(posterior.predicted))), q,
                                          out);
        return out;
    }

    Cartesian to_cartesian(const State& x) const { return flat(log_spherical::to_cartesian(full(x))); }
    Transition to_cartesian_jacobian(const State& x) const {
        return flat(log_spherical::to_cartesian_jacobian(full(x)));
    }
    State from_cartesian(const Cartesian& c) const { return flat(log_spherical::from_cartesian(full(c))); }
    Transition from_cartesian_jacobian(const Cartesian& c) const {
        return flat(log_spherical::from_cartesian_jacobian(log_spherical::from_cartesian(full(c))));
    }

private:
    /// Where component i stands among the six of three dimensions: the plane lacks the third of each triple, which is 0.
    static constexpr int place(int i) { return D == 3 ? i : (i < 2 ? i : i + 1); }
    static pelorus::Vector<6> full(const State& x) {
        pelorus::Vector<6> out = pelorus::Vector<6>::Zero();
        for (int i = 0; i < size; ++i) out(place(i)) = x(i);
        return out;
    }
    static State flat(const pelorus::Vector<6>& x) {
        State out;
        for (int i = 0; i < size; ++i) out(i) = x(place(i));
        return out;
    }
    static Transition flat(const pelorus::Matrix<6>& x) {
        Transition out;
        for (int c = 0; c < size; ++c)
            for (int r = 0; r < size; ++r) out(r, c) = x(place(r), place(c));
        return out;
    }
};

template <int D> void Model<D>::describe(pelorus::Describe<Model>& plugin) {
    plugin.title("Constant velocity in logarithmic spherical coordinates")
        .purpose(
            "Straight flight, estimated as logarithm of the range, angles, and velocity over the range: what angles "
            "alone tell of "
            "a target is kept apart from its range. For passive sensors at the origin that do not accelerate.")
        .equation(
            "p = r u_r, v = r (rho u_r + omega u_b + eta u_e), r = exp(log_range), rho = r'/r, omega = azimuth' "
            "cos(elevation), eta = "
            "elevation'; p' = p + T v in closed form; F = (ds'/dc') [I TI; 0 I] (dc/ds); Q = J q [T^3/3 T^2/2; T^2/2 "
            "T] (x) I J', J = "
            "ds'/dc'")
        .source(
            "V. J. Aidala, S. E. Hammel, Utilization of modified polar coordinates for bearings-only tracking, IEEE "
            "Transactions on Automatic Control 28(3), 283-294, 1983; M. Mallick, M. Morelande, L. Mihaylova, S. "
            "Arulampalam, "
            "Y. Yan, Angle-only filtering in three dimensions, in: Integrated Tracking, Classification, and Sensor "
            "Management, "
            "Wiley 2012, chapter 1");
    plugin.parameter("dimension", &Parameters::dimension)
        .initially("3")
        .min(2)
        .max(3)
        .doc("3, or 2 for range and azimuth in the x-y plane");
    plugin.parameter("noise", &Parameters::density)
        .unit("m2/s3")
        .initially("1 m2/s3")
        .min(0.0)
        .doc("spectral density of the acceleration on each Cartesian axis");
    plugin.parameter("mean_range", &Parameters::mean_range)
        .unit("m")
        .initially("10 km")
        .above(0.0)
        .doc("the range where nothing is known of it");
    plugin.parameter("prior_log_range", &Parameters::prior_log_range)
        .initially("1")
        .above(0.0)
        .doc("deviation of log_range where nothing is known of it: 0.7 is a factor of two");
    plugin.parameter("prior_angle", &Parameters::prior_angle)
        .unit("rad")
        .initially("1 rad")
        .above(0.0)
        .doc("deviation of an angle that nothing is known of, about 0");
    plugin.parameter("prior_rate", &Parameters::prior_rate)
        .unit("1/s")
        .initially("0.01 1/s")
        .above(0.0)
        .doc("deviation of a component of velocity over range that nothing is known of, about 0");
    pelorus::describe_priors(plugin, &Parameters::prior_position, &Parameters::prior_velocity);
}

struct LogSpherical {
    static constexpr const char* kind = Model<3>::kind;
    static constexpr const char* table_id = Model<3>::table_id;
    static constexpr const char* version = Model<3>::version;
    static const plr_description* description(const char* id) { return pelorus::Describe<Model<3>>::of(id).c(); }
    static plr_instance create(const pelorus::Setup& setup) {
        Model<3> chosen;
        pelorus::Describe<Model<3>>::of().bind(chosen, setup.raw());
        return chosen.dimension == 2 ? pelorus::instantiate<Model<2>>(setup) : pelorus::instantiate<Model<3>>(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(LogSpherical, "motion.log_spherical");
