// motion.ballistic: free flight under gravity and drag. See README.md.
#include "description.hpp"

#include "../../common/variants/variants.hpp"

namespace {

using namespace ballistic;

template <Drag drag_, Integration integration_> plr_instance free_flight(const pelorus::Setup& setup) {
    return pelorus::instantiate<Model<drag_, false, integration_, false>>(setup);
}

/// Chooses the class by the state, the integration and the noise.
struct Ballistic : variants::Variants<Model<Drag::none, false, Integration::runge_kutta, false>> {
    static plr_instance create(const pelorus::Setup& setup) {
        const Parameters chosen = parameters(setup);
        check(chosen);
        if (chosen.maneuver_rate) return manoeuvring(chosen, setup);
        // A force that is held takes drag as it comes; a flight that is integrated promises more without.
        if (chosen.integration == Integration::held) return free_flight<Drag::known, Integration::held>(setup);
        switch (chosen.drag) {
            case Drag::none:
                return free_flight<Drag::none, Integration::runge_kutta>(setup);
            case Drag::known:
                return free_flight<Drag::known, Integration::runge_kutta>(setup);
            default:
                return free_flight<Drag::estimated, Integration::runge_kutta>(setup);
        }
    }
};

}  // namespace

PELORUS_PLUGIN(Ballistic, "motion.ballistic");
