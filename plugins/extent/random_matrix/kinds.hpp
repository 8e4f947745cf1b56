/// The classes of extent.random_matrix are compiled apart: each of them takes its time.
#pragma once

#include <pelorus/setup.hpp>

namespace random_matrix {

/// An instance of the class for `dimension` axes.
plr_instance make_random_matrix(int dimension, const pelorus::Setup& setup);
plr_instance make_koch(int dimension, const pelorus::Setup& setup);
plr_instance make_variational(int dimension, const pelorus::Setup& setup);

}  // namespace random_matrix
