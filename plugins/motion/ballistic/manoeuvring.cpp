// The forms of motion.ballistic whose state has an acceleration beyond the forces.
#include "description.hpp"

namespace ballistic {

namespace {

template <Drag drag_, Integration integration_>
plr_instance with_noise(const Parameters& chosen, const pelorus::Setup& setup) {
    return chosen.over_extent ? pelorus::instantiate<Model<drag_, true, integration_, true>>(setup)
                              : pelorus::instantiate<Model<drag_, true, integration_, false>>(setup);
}

}  // namespace

plr_instance manoeuvring(const Parameters& chosen, const pelorus::Setup& setup) {
    if (chosen.integration == Integration::held) return with_noise<Drag::known, Integration::held>(chosen, setup);
    return chosen.drag == Drag::none ? with_noise<Drag::none, Integration::runge_kutta>(chosen, setup)
                                     : with_noise<Drag::known, Integration::runge_kutta>(chosen, setup);
}

}  // namespace ballistic
