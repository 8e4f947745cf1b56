/// Measurements as a tracker of points takes them: converted to positions, without a correction for the bend of angles, and with the
/// covariances that this gives to first order:
///     p = h^-1(z),   P = A R A',   A = (d h / d p)^-1 at p
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/LU>

#include <pelorus/caller.hpp>
#include <pelorus/parts.hpp>
#include <pelorus/space.hpp>

namespace simulation {

class Conversion {
public:
    /// Throws PartError for a sensor whose single measurements are not as many coordinates as its positions.
    explicit Conversion(const pelorus::SensorPart& part) : part_(part), positions_(*part.info().cartesian) {
        const plr_sensor_info& info = part_.info();
        const bool inverts = (info.flags & PLR_SENSOR_CAN_INVERT) != 0 && info.inverse != nullptr &&
                             pelorus::Space(*info.inverse).same(positions_);
        if (!inverts || positions_.size() > most || static_cast<int>(info.measurement->size) != positions_.size() ||
            !positions_.same(pelorus::position_space(positions_.size())))
            throw pelorus::PartError(
                "sensors", "sensor " + part_.name() + " cannot be converted: a measurement of it is not a position");
    }

    const pelorus::Space& space() const noexcept { return positions_; }

    /// Converts n measurements and their covariances in place.
    void convert(pelorus::Caller& caller, std::int64_t time, std::vector<double>& measurements,
                 std::vector<double>& covariances, std::int64_t n) const {
        const std::int64_t d = positions_.size();
        const std::vector<double> none(static_cast<std::size_t>(d * d), 0.0);  // no errors, so no correction for them
        std::vector<double> points(static_cast<std::size_t>(d * n)), slopes(static_cast<std::size_t>(d * d * n));
        auto invert = pelorus::arguments<plr_sensor_invert>();
        invert.measurement = pelorus::const_view(measurements.data(), d, 1, n);
        invert.noise = pelorus::common_view(none.data(), d, d, n);
        invert.mean = pelorus::view(points.data(), d, 1, n);
        caller.require(part_.call(&plr_sensor::invert, caller.begin(time, n), invert),
                       "sensor " + part_.name() + ", invert");
        auto slope = pelorus::arguments<plr_sensor_jacobian>();
        slope.cartesian = pelorus::const_view(points.data(), d, 1, n);
        slope.out = pelorus::view(slopes.data(), d, d, n);
        caller.require(part_.call(&plr_sensor::jacobian, caller.begin(time, n), slope),
                       "sensor " + part_.name() + ", jacobian");
        for (std::int64_t k = 0; k < n; ++k) carry(slopes.data() + k * d * d, covariances.data() + k * d * d);
        measurements = std::move(points);
    }

private:
    static constexpr int most = 3;

    /// P = A R A' with A the inverse of the slope, in the place of R.
    void carry(const double* slope, double* covariance) const {
        using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most, most>;
        const int d = positions_.size();
        const Eigen::PartialPivLU<Square> h(Square(Eigen::Map<const Eigen::MatrixXd>(slope, d, d)));
        Eigen::Map<Eigen::MatrixXd> r(covariance, d, d);
        const Square half = h.solve(Square(r)), full = h.solve(Square(half.transpose()));
        r = 0.5 * (full + full.transpose());
    }

    pelorus::SensorPart part_;
    pelorus::Space positions_;
};

}  // namespace simulation
