/// Bounds of means of normalised squares (ABI consistency.h).
#pragma once

namespace pelorus::report {

/// The quantile of chi-square with so many degrees of freedom, divided by them: a bound of what is 1 on average. NaN where there
/// are none. `probability` is within 0 and 1.
double chi_square_bound(double degrees, double probability);

}  // namespace pelorus::report
