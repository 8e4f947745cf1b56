// extent.random_matrix: the shape of an extended target as an inverse-Wishart matrix. See README.md.
#include "random_matrix.hpp"

#include "koch.hpp"

namespace {

using namespace random_matrix;

/// Chooses the class by update and dimension.
struct Plugin {
    using Described = RandomMatrix<3>;
    static constexpr const char* kind = Described::kind;
    static constexpr const char* table_id = Described::table_id;
    static constexpr const char* version = Described::version;

    static const plr_description* description(const char* id) { return pelorus::Describe<Described>::of(id).c(); }
    static plr_instance create(const pelorus::Setup& setup) {
        Described chosen;
        pelorus::Describe<Described>::of().bind(chosen, setup.raw());
        if (chosen.rule == Rule::koch)
            return chosen.dimension == 2 ? pelorus::instantiate<Koch<2>>(setup) : pelorus::instantiate<Koch<3>>(setup);
        return chosen.dimension == 2 ? pelorus::instantiate<RandomMatrix<2>>(setup)
                                     : pelorus::instantiate<RandomMatrix<3>>(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(Plugin, "extent.random_matrix");
