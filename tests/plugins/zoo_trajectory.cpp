// The zoo's trajectory: one object straight ahead, with a misdeed.
#include "zoo.hpp"

namespace {

struct ZooTrajectory : pelorus::Trajectory<ZooTrajectory> {
    using Base = pelorus::Trajectory<ZooTrajectory>;
    zoo::Fault fault = zoo::Fault::none;
    std::string in;
    pelorus::Space space = pelorus::kinematic_space(3, {1e6, 100.0});

    static void describe(pelorus::Describe<ZooTrajectory>& plugin) {
        plugin.title("A trajectory of the zoo");
        zoo::describe(plugin);
    }
    void setup(const pelorus::Setup&) {
        info.state = space.c();
        info.objects = 1;
        info.record_version = 1;
        info.record_size = 1;  // the speed
    }

    void realise(const plr_call&, const plr_view& record) const { record.data[0] = 100; }
    void states(const plr_call&, const plr_trajectory_states& args) const {
        const double speed = args.record.data[0];
        for (std::int64_t k = 0; k < args.time_count; ++k) {
            pelorus::Vector<6> state;
            state << speed * static_cast<double>(args.times[k]) * 1e-9, 0, 1000, speed, 0, 0;
            pelorus::store<6, 1>(args.states, 0, state, k);
        }
        args.ids[0] = 0;
        args.parents[0] = -1;
        args.births[0] = 0;
        args.deaths[0] = std::numeric_limits<std::int64_t>::max();
    }

    static const ZooTrajectory& of(const void* self) { return *static_cast<const ZooTrajectory*>(self); }
    static plr_status realise_entry(const void* self, const plr_call* call, const plr_view* record) {
        return zoo::act(of(self), "realise", call, {}, *record,
                        [&] { return Base::table().realise(self, call, record); });
    }
    static plr_status states_entry(const void* self, const plr_call* call, const plr_trajectory_states* args) {
        return zoo::act(of(self), "states", call, args->record, args->states,
                        [&] { return Base::table().states(self, call, args); });
    }
    static const plr_trajectory& table() {
        static const plr_trajectory zoo = [] {
            plr_trajectory t = Base::table();
            t.head.destroy = &zoo::destroy<ZooTrajectory>;
            t.realise = &realise_entry;
            t.states = &states_entry;
            return t;
        }();
        return zoo;
    }
};

}  // namespace

ZOO_PLUGIN(ZooTrajectory, "org.example.trajectory.zoo");
