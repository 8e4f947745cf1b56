/// Half widths of 95 % confidence intervals. None (no value) where there are too few samples to say anything, or the estimate
/// has no such interval.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace pelorus::campaign {

/// How much each run moves an estimate, to first order: its influence divided by the number of runs. All add up to zero.
using Contributions = std::vector<double>;

/// An estimate from one value a run.
struct Estimate {
    double value = 0;        ///< NaN where no value is finite
    std::size_t finite = 0;  ///< values that went in
    Contributions
        contributions;  ///< [runs] 0 of a value that is not finite; empty where the estimate has none (extremes, quantiles)
};

/// What `values` reduce to (PLR_REDUCE_...); non-finite ones are left out. Weights count in a mean: that is then a ratio of two
/// means (Cochran, Sampling Techniques, 1977, 6.3). A root mean square is linearised (delta method).
Estimate estimate_of(std::uint32_t reduce, double quantile, const std::vector<double>& values,
                     const std::vector<double>& weights);

/// Student's interval of an estimate, or of the difference of two made from the same runs, by the contributions' squares. For a
/// mean it is the textbook's, for a difference of two means that of the paired t test.
std::optional<double> ci95_of(const Contributions& contributions, std::size_t runs);

/// Of a quantile of ascending values, free of any distribution: half the distance of the order statistics between which it lies
/// with a probability of 95 % (David and Nagaraja, Order Statistics, 2003, 7.1).
std::optional<double> quantile_ci95(const std::vector<double>& sorted, double probability);

/// An estimate made anew from all runs but those of a group, for each group.
struct Jackknife {
    std::vector<double> without;        ///< [groups] the estimate without that group; NaN: there is none
    std::vector<std::uint64_t> counts;  ///< [groups] runs of the group
};

/// The delete-a-group jackknife for groups that differ in size (Busing, Meijer and van der Leeden, Statistics and Computing 9,
/// 1999), with Student's t of one degree of freedom less than there are groups.
std::optional<double> jackknife_ci95(double estimate, const Jackknife& jackknife);

}  // namespace pelorus::campaign
