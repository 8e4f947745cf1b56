/// Where on the Earth a sensor stands, among the axes of the scene.
#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <GeographicLib/LocalCartesian.hpp>

namespace simulation {

/// Axes east, north, up at a site, as the scene's axes see them, which are east, north, up at its origin (WGS84):
///     scene = M site + p
/// Source: C. F. F. Karney, GeographicLib, LocalCartesian.
class Site {
public:
    /// Latitude and longitude (rad), height (m).
    Site(const std::vector<double>& origin, const std::vector<double>& site) {
        const double degrees = 45.0 / std::atan(1.0);
        const GeographicLib::LocalCartesian scene(origin[0] * degrees, origin[1] * degrees, origin[2]);
        std::vector<double> rotation(9);
        scene.Forward(site[0] * degrees, site[1] * degrees, site[2], place_(0), place_(1), place_(2), rotation);
        rotation_ = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data());
    }

    /// Positions (3 each, m) of the scene become those of the site.
    void to_site(std::vector<double>& points) const {
        for (std::size_t k = 0; k + 3 <= points.size(); k += 3) {
            Eigen::Map<Eigen::Vector3d> point(points.data() + k);
            point = (rotation_.transpose() * (point - place_)).eval();
        }
    }
    /// The way back, for positions and their covariances (3 x 3 each, m^2).
    void to_scene(std::vector<double>& points, std::vector<double>& covariances) const {
        for (std::size_t k = 0; k + 3 <= points.size(); k += 3) {
            Eigen::Map<Eigen::Vector3d> point(points.data() + k);
            point = (rotation_ * point + place_).eval();
            Eigen::Map<Eigen::Matrix3d> covariance(covariances.data() + 3 * k);
            const Eigen::Matrix3d moved = rotation_ * covariance * rotation_.transpose();
            covariance = 0.5 * (moved + moved.transpose());
        }
    }

private:
    Eigen::Matrix3d rotation_;
    Eigen::Vector3d place_;
};

}  // namespace simulation
