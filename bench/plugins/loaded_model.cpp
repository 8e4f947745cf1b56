// The code of the fifty plugins whose loading is measured: a motion like those of the tree, compiled once. What makes a
// library of it is loaded_entry.c, once for each id.
#include <pelorus/axis_motion.hpp>

namespace {

template <int D> struct Loaded : pelorus::AxisMotion<Loaded<D>, 2, D> {
    int dimension = 3;
    std::vector<double> density;  // m2/s3
    double prior_position = 0.0, prior_velocity = 0.0;

    static void describe(pelorus::Describe<Loaded>& plugin) {
        plugin.title("A model to be loaded").purpose("Is loaded with many others of its kind, which takes time.");
        plugin.parameter("dimension", &Loaded::dimension).initially("3").min(1).max(3).doc("number of axes");
        plugin.parameter("noise", &Loaded::density)
            .unit("m2/s3")
            .initially("1 m2/s3")
            .min(0.0)
            .rows(1, 3)
            .doc("spectral density of the acceleration");
        pelorus::describe_priors(plugin, &Loaded::prior_position, &Loaded::prior_velocity);
    }
    void setup(const pelorus::Setup&) { this->intensity = pelorus::per_axis<D>("noise", density); }
    pelorus::Matrix<2> transition(double dt) const {
        pelorus::Matrix<2> f;
        f << 1.0, dt, 0.0, 1.0;
        return f;
    }
    pelorus::Matrix<2> unit_noise(double dt) const {
        pelorus::Matrix<2> q;
        q << dt * dt * dt / 3.0, dt * dt / 2.0, dt * dt / 2.0, dt;
        return q;
    }
    std::vector<double> priors() const { return {prior_position, prior_velocity}; }
};

}  // namespace

extern "C" const plr_plugin* loaded_model(const char* id, const char* wanted) {
    return pelorus::detail::plugin<pelorus::ByDimension<Loaded>>(id, wanted);
}
