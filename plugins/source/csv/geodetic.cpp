#include "geodetic.hpp"

#include <cmath>

namespace source_csv {

namespace {

constexpr double degree = 3.14159265358979323846 / 180;

plr_error empty_error() {
    plr_error error{};
    error.struct_size = sizeof error;
    error.item = -1;
    return error;
}

}  // namespace

void GeodeticFrame::setup(const pelorus::Setup& setup, const std::optional<std::vector<double>>& origin) {
    frame_ = setup.frame();
    frames_ = setup.optional_service<plr_frames>();
    plr_error error = empty_error();
    const double centre[3] = {0, 0, 0};
    double place[3] = {0, 0, 0};
    const bool on_earth =
        frames_ != nullptr && frames_->to_geodetic(frames_->context, frame_.c_str(), centre, place, &error) == PLR_OK;
    if (on_earth && origin)
        throw pelorus::ParameterError("origin", "frame " + frame_ + " stands on Earth already; leave origin out");
    if (on_earth) {
        height_ = place[2];
        return;
    }
    if (!origin)
        throw pelorus::ParameterError(
            "origin", "latitudes and longitudes need an origin, or a frame of the node that stands on Earth");
    const std::vector<double>& o = *origin;
    if (!(std::abs(o[0]) <= 90 * degree * (1 + 1e-15)))
        throw pelorus::ParameterError("origin", "has a latitude beyond the poles");
    local_.emplace(o[0] / degree, o[1] / degree, o[2]);
    height_ = o[2];
}

std::array<double, 3> GeodeticFrame::position(double latitude, double longitude, double height) const {
    std::array<double, 3> p{};
    if (local_) {
        local_->Forward(latitude / degree, longitude / degree, height, p[0], p[1], p[2]);
        return p;
    }
    plr_error error = empty_error();
    const double geodetic[3] = {latitude, longitude, height};
    if (frames_->from_geodetic(frames_->context, frame_.c_str(), geodetic, p.data(), &error) != PLR_OK)
        throw pelorus::DataError(error.message);
    return p;
}

}  // namespace source_csv
