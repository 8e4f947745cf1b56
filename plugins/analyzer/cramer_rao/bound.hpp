/// The recursion of a posterior Cramer-Rao bound.
#pragma once

#include <pelorus/failure.hpp>
#include <pelorus/small_matrix.hpp>

#include "models.hpp"

namespace cramer_rao {

/// What is left of a covariance after a measurement of Jacobian H and noise R: (P^-1 + H' R^-1 H)^-1, in Joseph's form, for which P
/// may be singular and many orders of magnitude larger than R. Throws NumericError where P or R is no covariance.
inline Eigen::MatrixXd measured(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& jacobian,
                                const Eigen::MatrixXd& noise) {
    using States = pelorus::small::Bounded<most_states, most_states>;
    using Measured = pelorus::small::Bounded<most_measured, most_measured>;
    using Across = pelorus::small::Bounded<most_measured, most_states>;
    using Gain = pelorus::small::Bounded<most_states, most_measured>;
    const Eigen::Index n = covariance.rows(), m = noise.rows();
    const States p = covariance;
    const Across h = jacobian;
    const Measured r = noise;
    States factor(n, n), out(n, n);
    Measured noise_factor(m, m), innovation(m, m), root(m, m);
    Across seen(m, n), cross(m, n);
    if (!pelorus::small::cholesky_semidefinite(p, factor)) throw pelorus::NumericError("a bound is no covariance");
    if (!pelorus::small::cholesky(r, noise_factor))
        throw pelorus::NumericError("a measurement's noise is not positive definite");
    pelorus::small::multiply(h, factor, seen);
    pelorus::small::multiply_transposed(seen, factor, cross);  // H P
    innovation = r;
    pelorus::small::add_gram(seen, innovation);
    if (!pelorus::small::cholesky(innovation, root))
        throw pelorus::NumericError("an innovation covariance is not positive definite");
    pelorus::small::cholesky_solve(root, cross);  // K' = S^-1 H P
    const Gain gain = cross.transpose();
    pelorus::small::joseph_update(factor, seen, noise_factor, gain, out);
    return out;
}

}  // namespace cramer_rao
