// One object without shape on a straight line, at constant speed.
#include <limits>

#include <pelorus/batch_model.hpp>
#include <pelorus/matrix.hpp>

#include "reference_parts.hpp"

namespace pelorus::conformance {

namespace {

struct Trajectory : pelorus::Trajectory<Trajectory> {
    Vector<3> start, velocity;
    Space space = kinematic_space(3, {1e5, 100.0});

    static void describe(Describe<Trajectory>& plugin) {
        plugin.title("Straight line, three axes");
        plugin.parameter("start", &Trajectory::start).unit("m").initially("[1 km, 2 km, 500 m]").doc("where it begins");
        plugin.parameter("velocity", &Trajectory::velocity).unit("m/s").initially("[50, -30, 5]").doc("how it moves");
    }

    void setup(const Setup&) {
        info.state = space.c();
        info.objects = 1;
        info.record_version = 1;
    }

    void realise(const plr_call&, const plr_view& record) const { expect(record, 0, 1, 1, "record"); }

    void states(const plr_call&, const plr_trajectory_states& args) const {
        expect(args.states, 6, args.time_count, 1, "states");
        for (std::int64_t k = 0; k < args.time_count; ++k) {
            Vector<6> state;
            state << start + velocity * (static_cast<double>(args.times[k]) * 1e-9), velocity;
            store<6, 1>(args.states, 0, state, k);
        }
        args.ids[0] = 0;
        args.parents[0] = -1;
        args.births[0] = 0;
        args.deaths[0] = std::numeric_limits<std::int64_t>::max();
    }
};

}  // namespace

const plr_plugin* reference_trajectory() {
    return pelorus::detail::plugin<Trajectory>("pelorus.conformance.trajectory", "pelorus.conformance.trajectory");
}

}  // namespace pelorus::conformance
