#include "koch.hpp"

#include "kinds.hpp"

plr_instance random_matrix::make_koch(int dimension, const pelorus::Setup& setup) {
    return dimension == 2 ? pelorus::instantiate<Koch<2>>(setup) : pelorus::instantiate<Koch<3>>(setup);
}
