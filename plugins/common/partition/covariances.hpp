/// Covariances of a scan's points and of predictions, and the gates made from them.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <boost/math/distributions/chi_squared.hpp>
#include <pelorus/small_matrix.hpp>

#include "scan.hpp"

namespace partition {

/// The chi-square quantile of one probability for 1, 2 and 3 degrees of freedom: what e' S^-1 e of a Gaussian e ~ N(0, S) is
/// below with that probability. For create(), not for hot calls.
class Gate {
public:
    void set(double probability) {
        for (int degrees = 1; degrees <= 3; ++degrees)
            quantile_[static_cast<std::size_t>(degrees)] =
                boost::math::quantile(boost::math::chi_squared(degrees), probability);
    }
    double operator()(std::int64_t degrees) const noexcept { return quantile_[static_cast<std::size_t>(degrees)]; }

private:
    std::array<double, 4> quantile_{};
};

/// Throws ArgumentError or NumericError unless the view holds `count` symmetric matrices without a negative eigenvalue (or one
/// common to all), D x D; `definite`: without one that is 0, too.
template <int D>
void expect_covariances(const plr_const_view& view, std::int64_t count, const char* what, bool definite = false) {
    pelorus::expect(view, D, D, count, what);
    const std::int64_t items = view.item_stride == 0 ? std::min<std::int64_t>(count, 1) : count;
    for (std::int64_t i = 0; i < items; ++i) {
        const pelorus::Matrix<D> p = pelorus::load<D, D>(view, i);
        pelorus::Matrix<D> root;
        if (!(definite ? pelorus::small::cholesky(p, root) : pelorus::small::cholesky_semidefinite(p, root)))
            throw pelorus::NumericError(std::string(what) + " " + std::to_string(i) + " is not positive " +
                                        (definite ? "definite" : "semidefinite"));
    }
}

/// Item i of covariances that may be unknown (data NULL), which counts as 0.
template <int D> pelorus::Matrix<D> known_or_zero(const plr_const_view& view, std::int64_t i) noexcept {
    return view.data == nullptr ? pelorus::Matrix<D>(pelorus::Matrix<D>::Zero()) : pelorus::load<D, D>(view, i);
}

}  // namespace partition
