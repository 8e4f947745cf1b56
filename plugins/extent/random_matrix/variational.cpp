#include "variational.hpp"

#include "kinds.hpp"

plr_instance random_matrix::make_variational(int dimension, const pelorus::Setup& setup) {
    return dimension == 2 ? pelorus::instantiate<Variational<2>>(setup) : pelorus::instantiate<Variational<3>>(setup);
}
