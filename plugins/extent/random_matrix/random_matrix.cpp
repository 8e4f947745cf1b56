// extent.random_matrix: the shape of an extended target as an inverse-Wishart matrix. See README.md.
#include "random_matrix.hpp"

#include "kinds.hpp"

namespace random_matrix {

plr_instance make_random_matrix(int dimension, const pelorus::Setup& setup) {
    return dimension == 2 ? pelorus::instantiate<RandomMatrix<2>>(setup) : pelorus::instantiate<RandomMatrix<3>>(setup);
}

namespace {

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
        if (!is_joint(chosen.rule)) return make_random_matrix(chosen.dimension, setup);
        if (chosen.rule == Rule::variational) return make_variational(chosen.dimension, setup);
        return make_koch(chosen.dimension, setup);
    }
};

}  // namespace

}  // namespace random_matrix

PELORUS_PLUGIN(random_matrix::Plugin, "extent.random_matrix");
