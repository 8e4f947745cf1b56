#include "converted.hpp"

namespace converted {

namespace {

/// Chooses the class by what the filter inside allows.
struct Plugin {
    using Described = Converted<true>;
    static constexpr const char* kind = Described::kind;
    static constexpr const char* table_id = Described::table_id;
    static constexpr const char* version = Described::version;

    static const plr_description* description(const char* id) { return pelorus::Describe<Described>::of(id).c(); }
    static plr_instance create(const pelorus::Setup& setup) {
        const auto filter = setup.part<pelorus::EstimatorPart>("estimator");
        return (filter.info().flags & PLR_ESTIMATOR_ASSIGNABLE) != 0 ? pelorus::instantiate<Converted<true>>(setup)
                                                                     : pelorus::instantiate<Converted<false>>(setup);
    }
};

}  // namespace

}  // namespace converted

PELORUS_PLUGIN(converted::Plugin, "estimator.converted");
