/// How the points of an extended target lie in its ellipsoid: the parameter that extents share.
#pragma once

#include <pelorus/describe.hpp>

namespace random_matrix {

/// `lambda`: covariance of points = lambda X, with X the extent matrix.
template <class Plugin, class Parameters>
void describe_lambda(pelorus::Describe<Plugin>& plugin, double Parameters::*lambda) {
    plugin.parameter("lambda", lambda)
        .initially("1")
        .above(0)
        .doc(
            "covariance of points over the extent matrix: 1 for Gaussian points, 1/5 for a uniform ellipsoid, 1/4 for "
            "a uniform ellipse");
}

}  // namespace random_matrix
