#include "imm.hpp"

namespace imm {

namespace {

/// Chooses the class by the models' components.
struct Plugin {
    using Described = Imm<true>;
    static constexpr const char* kind = Described::kind;
    static constexpr const char* table_id = Described::table_id;
    static constexpr const char* version = Described::version;

    static const plr_description* description(const char* id) { return pelorus::Describe<Described>::of(id).c(); }
    static plr_instance create(const pelorus::Setup& setup) {
        const auto parts = setup.parts<pelorus::EstimatorPart>("estimators");
        bool is_shared = true;
        for (const auto& part : parts) {
            const plr_estimator_info &first = parts.front().info(), &own = part.info();
            is_shared = is_shared && pelorus::Space(*own.state).same(pelorus::Space(*first.state)) &&
                        pelorus::Space(*own.cartesian).same(pelorus::Space(*first.cartesian));
        }
        return is_shared ? pelorus::instantiate<Imm<true>>(setup) : pelorus::instantiate<Imm<false>>(setup);
    }
};

}  // namespace

}  // namespace imm

PELORUS_PLUGIN(imm::Plugin, "estimator.imm");
