/// Latitude, longitude and height to coordinates of a local frame.
#pragma once

#include <array>
#include <optional>
#include <string>

#include <GeographicLib/LocalCartesian.hpp>
#include <pelorus/setup.hpp>

namespace source_csv {

/// East, north, up at an origin of its own, or a frame of the config that stands on Earth.
class GeodeticFrame {
public:
    /// `origin` (rad, rad, m above the WGS84 ellipsoid) may be absent: then the frame decides. Throws ParameterError where
    /// both or neither say where the coordinates stand.
    void setup(const pelorus::Setup& setup, const std::optional<std::vector<double>>& origin);

    /// Height of the origin, for recordings that tell no heights, m.
    double origin_height() const noexcept { return height_; }

    /// Coordinates in m. Latitude in [-pi/2, pi/2], finite numbers. Throws DataError.
    std::array<double, 3> position(double latitude, double longitude, double height) const;

private:
    std::optional<GeographicLib::LocalCartesian> local_;
    const plr_frames* frames_ = nullptr;
    std::string frame_;
    double height_ = 0;
};

}  // namespace source_csv
