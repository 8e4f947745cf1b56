/// A measurement of one sensor, as another one would have made it from elsewhere.
#pragma once

#include <string>
#include <vector>

#include <pelorus/caller.hpp>
#include <pelorus/messages.hpp>

#include "placement.hpp"

namespace rigid {

/// What becomes of the covariance of a measurement.
enum class Covariance { transformed, kept };

/// Takes measurements of a sensor through its point to what `into` sees, or to the point itself:
///     z' = h'(p'),  p' = R p + t,  h(p) = z          R' = G R_z G',  G = H' R H^-1
/// h, H: measurement and Jacobian of the one sensor, h', H' of the other. In the plane z stays 0.
class SensorMove {
public:
    SensorMove() = default;
    /// `into` may be empty: then the position is told. Throws PartError for a sensor that tells no position by itself, or where both
    /// do not look at the same number of axes.
    SensorMove(const pelorus::SensorPart& from, const pelorus::SensorPart& into);

    const pelorus::Space& space() const noexcept { return space_; }
    std::uint64_t scratch_bytes() const;
    bool is_of_plane() const noexcept { return dimension_ == 2; }

    struct Moved {
        std::vector<double> measurements;  ///< m' a measurement
        std::vector<double> covariances;   ///< m' x m', or m x m as they were
        std::vector<bool> is_good;         ///< no: the point is where angles are not told, or none
    };
    /// All measurements of a scan at `time` (ns).
    Moved operator()(const plr_scan& scan, std::int64_t time, const Motion& motion, Covariance covariance,
                     pelorus::Caller& caller) const;

private:
    struct Batch;
    void find_points(Batch& batch, pelorus::Caller& caller) const;
    void find_noise(Batch& batch, const plr_scan& scan, Covariance covariance, pelorus::Caller& caller) const;
    std::vector<double> slopes(const pelorus::SensorPart& sensor, const std::vector<double>& points, Batch& batch,
                               pelorus::Caller& caller) const;
    void transform_noise(Batch& batch, const Motion& motion, pelorus::Caller& caller) const;

    pelorus::SensorPart from_, into_;
    pelorus::Space space_;
    std::int64_t dimension_ = 3;
};

}  // namespace rigid
