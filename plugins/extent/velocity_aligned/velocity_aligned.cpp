// extent.velocity_aligned: the shape of a target that keeps its attitude to its velocity. See README.md.
#include "running.hpp"
#include "weighed.hpp"

namespace velocity_aligned {

namespace {

/// Chooses the class by weighing and dimension.
struct Plugin {
    using Described = Aligned<Running<3>, 3>;
    static constexpr const char* kind = Described::kind;
    static constexpr const char* table_id = Described::table_id;
    static constexpr const char* version = Described::version;

    static const plr_description* description(const char* id) { return pelorus::Describe<Described>::of(id).c(); }
    static plr_instance create(const pelorus::Setup& setup) {
        Described chosen;
        pelorus::Describe<Described>::of().bind(chosen, setup.raw());
        if (chosen.weighing == Weighing::none)
            return chosen.dimension == 2 ? pelorus::instantiate<Aligned<Running<2>, 2>>(setup)
                                         : pelorus::instantiate<Aligned<Running<3>, 3>>(setup);
        return chosen.dimension == 2 ? pelorus::instantiate<Aligned<Weighed<2>, 2>>(setup)
                                     : pelorus::instantiate<Aligned<Weighed<3>, 3>>(setup);
    }
};

}  // namespace

}  // namespace velocity_aligned

PELORUS_PLUGIN(velocity_aligned::Plugin, "extent.velocity_aligned");
