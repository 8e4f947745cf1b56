// The zoo's motion: constant velocity, with a misdeed.
#include <atomic>

#include "zoo.hpp"

namespace {

struct ZooMotion : pelorus::KroneckerMotion<ZooMotion, 2, 3> {
    using Base = pelorus::KroneckerMotion<ZooMotion, 2, 3>;
    zoo::Fault fault = zoo::Fault::none;
    std::string in;
    mutable std::atomic<bool> has_worked{false};

    static void describe(pelorus::Describe<ZooMotion>& plugin) {
        plugin.title("A motion of the zoo");
        zoo::describe(plugin);
    }
    std::vector<double> priors() const { return {1e6, 100.0}; }
    Block transition(double dt) const { return (Block() << 1, dt, 0, 1).finished(); }
    Block noise_block(double dt) const {
        return (Block() << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt).finished();
    }
    const void* extension(const char*) const noexcept { return nullptr; }  // so that its functions are called

    static const ZooMotion& of(const void* self) { return *static_cast<const ZooMotion*>(self); }
    static const plr_motion_info* info_entry(const void* self) {
        static const plr_motion_info other = [self] {
            plr_motion_info changed = *Base::table().info(self);
            changed.record_size = 3;
            return changed;
        }();
        const ZooMotion& zoo = of(self);
        if (zoo.in == "info") zoo::misbehave(zoo.fault);
        return zoo.fault == zoo::Fault::size && zoo.has_worked ? &other : Base::table().info(self);
    }
    static plr_status propagate_entry(const void* self, const plr_call* call, const plr_motion_propagate* args) {
        of(self).has_worked = true;
        return zoo::act(of(self), "propagate", call, args->state, args->out,
                        [&] { return Base::table().propagate(self, call, args); });
    }
    static plr_status jacobian_entry(const void* self, const plr_call* call, const plr_motion_jacobian* args) {
        return zoo::act(of(self), "jacobian", call, args->state, args->out,
                        [&] { return Base::table().jacobian(self, call, args); });
    }
    static plr_status noise_entry(const void* self, const plr_call* call, const plr_motion_noise* args) {
        return zoo::act(of(self), "noise", call, args->state, args->out,
                        [&] { return Base::table().noise(self, call, args); });
    }
    static const plr_motion& table() {
        static const plr_motion zoo = [] {
            plr_motion t = Base::table();
            t.head.destroy = &zoo::destroy<ZooMotion>;
            t.info = &ZooMotion::info_entry;
            t.propagate = &ZooMotion::propagate_entry;
            t.jacobian = &ZooMotion::jacobian_entry;
            t.noise = &ZooMotion::noise_entry;
            return t;
        }();
        return zoo;
    }
};

}  // namespace

ZOO_PLUGIN(ZooMotion, "org.example.motion.zoo");
