#include "report/chi_square.hpp"

#include <limits>

#include <boost/math/distributions/chi_squared.hpp>

namespace pelorus::report {

double chi_square_bound(double degrees, double probability) {
    if (!(degrees > 0)) return std::numeric_limits<double>::quiet_NaN();
    return boost::math::quantile(boost::math::chi_squared(degrees), probability) / degrees;
}

}  // namespace pelorus::report
