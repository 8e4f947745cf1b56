// extent.group_random_matrix: the shape of a group of objects. See README.md.
#include "group_random_matrix.hpp"

namespace group_random_matrix {

namespace {

/// Chooses the class by dimension.
struct Plugin {
    using Described = GroupRandomMatrix<3>;
    static constexpr const char* kind = Described::kind;
    static constexpr const char* table_id = Described::table_id;
    static constexpr const char* version = Described::version;

    static const plr_description* description(const char* id) { return pelorus::Describe<Described>::of(id).c(); }
    static plr_instance create(const pelorus::Setup& setup) {
        Described chosen;
        pelorus::Describe<Described>::of().bind(chosen, setup.raw());
        return chosen.dimension == 2 ? pelorus::instantiate<GroupRandomMatrix<2>>(setup)
                                     : pelorus::instantiate<GroupRandomMatrix<3>>(setup);
    }
};

}  // namespace

}  // namespace group_random_matrix

PELORUS_PLUGIN(group_random_matrix::Plugin, "extent.group_random_matrix");
