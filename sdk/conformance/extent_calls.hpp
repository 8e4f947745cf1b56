/// The calls of an extent, or of a joint one: with plausible arguments for the checks of all models, with given ones for its own.
#pragma once

#include <string>
#include <vector>

#include "machine/arguments.hpp"
#include "machine/hot_call.hpp"

namespace pelorus::conformance {

/// The points of some objects in one scan.
struct PointsOfScan {
    Argument points, noise, weights;  ///< ragged alike; weights may be absent

    std::int64_t count() const { return static_cast<std::int64_t>(points.offsets.size()) - 1; }
    /// Columns: the points of item i.
    Eigen::Map<const Eigen::MatrixXd> of_item(std::int64_t i) const;
};

class ExtentCalls {
public:
    explicit ExtentCalls(const Instance& instance_);

    bool is_joint() const noexcept { return joint != nullptr; }
    // The kinematics are c x 1 (positions, velocities); a joint extent keeps its own and is not given any.
    HotCall init(const std::vector<PointsOfScan>& scans, const Argument& times, const Argument& mean,
                 const Argument& covariance) const;
    HotCall predict(const Argument& dt, const Argument& record, const Argument& before, const Argument& after,
                    const Argument& before_covariance, const Argument& after_covariance) const;
    HotCall effective_noise(const Argument& record, const Argument& noise, const Argument& number) const;
    HotCall update(const PointsOfScan& scan, const Argument& record, const Argument& innovation,
                   const Argument& innovation_covariance, const Argument& kinematics,
                   const Argument& kinematics_covariance) const;
    HotCall shape(const Argument& record) const;
    HotCall gate(const PointsOfScan& scan, const Argument& record, const Argument& predicted,
                 const Argument& covariance) const;
    HotCall summary(const Argument& record) const;  ///< of a joint one

    const Instance& instance;
    const plr_extent& table;
    const plr_extent_joint* const joint;
    const plr_extent_info& info;
    const std::int64_t d, c;
};

/// An ellipsoid: where its points lie, and what a sensor makes of them.
struct Body {
    Eigen::VectorXd centre, velocity;
    Eigen::MatrixXd shape, noise;
};
Body sample_body(const ExtentCalls& calls, Sample& sample);
/// `points` of them a body, N(centre, shape + noise).
PointsOfScan sample_scan(const std::vector<Body>& bodies, const std::vector<std::int64_t>& points, Sample& sample);
/// Records that the bodies' first scans start, taken at whole seconds; the kinematics are exact.
struct StartedExtents {
    HotCall call;
    Argument record;
};
StartedExtents start_extents(const ExtentCalls& calls, const std::vector<Body>& bodies, Sample& sample);
/// Positions and velocities of the bodies: the kinematics where c = 2 d; what else there is, is zero.
Argument kinematics_of(const ExtentCalls& calls, const std::string& name, const std::vector<Body>& bodies,
                       double seconds = 0);

}  // namespace pelorus::conformance
