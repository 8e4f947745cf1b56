// A library of the zoo whose static constructor does what the variable PELORUS_ZOO_STATIC names.
#include <cstdlib>
#include <cstring>

#include "zoo.hpp"

namespace {

struct Static {
    Static() {
        const char* fault = std::getenv("PELORUS_ZOO_STATIC");
        if (fault == nullptr) return;
        if (std::strcmp(fault, "throws") == 0) zoo::misbehave(zoo::Fault::throws);
        if (std::strcmp(fault, "segfault") == 0) zoo::misbehave(zoo::Fault::segfault);
    }
};
const Static constructed;

struct StaticMotion : pelorus::KroneckerMotion<StaticMotion, 2, 3> {
    static void describe(pelorus::Describe<StaticMotion>& plugin) {
        plugin.title("A motion whose library has a static constructor");
    }
    std::vector<double> priors() const { return {1e6, 100.0}; }
    Block transition(double dt) const { return (Block() << 1, dt, 0, 1).finished(); }
    Block noise_block(double dt) const {
        return (Block() << dt * dt * dt / 3, dt * dt / 2, dt * dt / 2, dt).finished();
    }
};

}  // namespace

PELORUS_PLUGIN(StaticMotion, "org.example.motion.zoo_static");
