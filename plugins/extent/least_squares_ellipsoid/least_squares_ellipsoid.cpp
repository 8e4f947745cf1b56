// extent.least_squares_ellipsoid: the quadric through each scan's points. See README.md.
#include "least_squares_ellipsoid.hpp"

namespace least_squares_ellipsoid {

namespace {

/// Chooses the class by dimension.
struct Plugin {
    using Described = LeastSquaresEllipsoid<3>;
    static constexpr const char* kind = Described::kind;
    static constexpr const char* table_id = Described::table_id;
    static constexpr const char* version = Described::version;

    static const plr_description* description(const char* id) { return pelorus::Describe<Described>::of(id).c(); }
    static plr_instance create(const pelorus::Setup& setup) {
        Described chosen;
        pelorus::Describe<Described>::of().bind(chosen, setup.raw());
        return chosen.dimension == 2 ? pelorus::instantiate<LeastSquaresEllipsoid<2>>(setup)
                                     : pelorus::instantiate<LeastSquaresEllipsoid<3>>(setup);
    }
};

}  // namespace

}  // namespace least_squares_ellipsoid

PELORUS_PLUGIN(least_squares_ellipsoid::Plugin, "extent.least_squares_ellipsoid");
