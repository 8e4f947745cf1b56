#include <cmath>
#include <Eigen/Dense>
#include <GeographicLib/Geocentric.hpp>
#include <stdexcept>

#include "host/first_size.hpp"
#include "host/plugin_error.hpp"
#include "host/services.hpp"

namespace pelorus::host {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double degree = 0.017453292519943295769236907684886;  // rad
constexpr double rotation_tolerance = 1e-6;  // a rotation given with six digits passes, a mirror or a scale does not
constexpr std::size_t longest_name = 256;

/// Where a frame stands: p_outer = rotation p + translation.
struct Isometry {
    Matrix3d rotation;
    Vector3d translation;
};

Vector3d leave(const Isometry& frame, const Vector3d& inside) { return frame.rotation * inside + frame.translation; }
Vector3d enter(const Isometry& frame, const Vector3d& outside) {
    return frame.rotation.transpose() * (outside - frame.translation);
}

/// inner within middle, middle within outer: inner within outer.
Isometry compose(const Isometry& outer, const Isometry& inner) {
    return {outer.rotation * inner.rotation, leave(outer, inner.translation)};
}

/// From one frame into another, both given within the same outer one.
Isometry between(const Isometry& from, const Isometry& to) {
    return {to.rotation.transpose() * from.rotation, enter(to, from.translation)};
}

template <class Pose> Isometry read(const Pose& pose) {
    return {Matrix3d::Map(pose.rotation), Vector3d::Map(pose.translation)};
}

void write(const Isometry& isometry, double rotation[9], double translation[3]) {
    Matrix3d::Map(rotation) = isometry.rotation;
    Vector3d::Map(translation) = isometry.translation;
}

void check_new_name(const std::string& name, bool is_taken) {
    if (name.empty()) throw std::invalid_argument("a frame must have a name (the root frame has none)");
    if (is_taken) throw std::invalid_argument("frame " + name + " is there already");
}

bool is_rotation(const Matrix3d& matrix) {
    return matrix.allFinite() &&
           (matrix.transpose() * matrix - Matrix3d::Identity()).cwiseAbs().maxCoeff() < rotation_tolerance &&
           matrix.determinant() > 0;
}

bool is_geodetic(double latitude, double longitude, double height) {
    return std::isfinite(longitude) && std::isfinite(height) && std::abs(latitude) <= 90 * degree * (1 + 1e-15);
}

std::string show(const char* name) {
    return *name == '\0' ? "the root frame" : "frame " + one_line(name, longest_name);
}

}  // namespace

FrameTree::FrameTree() {
    frames_.emplace("", Frame{"", Pose{}});
    service_ = {sizeof service_, 0, this, transform, from_geodetic, to_geodetic};
}

void FrameTree::add_local(const std::string& name, const std::string& parent, const double rotation[9],
                          const double translation[3]) {
    check_new_name(name, contains(name));
    const auto found = frames_.find(parent);
    if (found == frames_.end()) throw std::invalid_argument("frame " + name + " has the unknown parent " + parent);
    const Isometry to_parent{Matrix3d::Map(rotation), Vector3d::Map(translation)};
    if (!is_rotation(to_parent.rotation) || !to_parent.translation.allFinite())
        throw std::invalid_argument("frame " + name +
                                    " has a matrix that is no rotation, or a translation that is not finite");
    const Frame& outer = found->second;
    Pose to_anchor;
    write(compose(read(outer.to_anchor), to_parent), to_anchor.rotation, to_anchor.translation);
    frames_.emplace(name, Frame{outer.anchor, to_anchor});
}

void FrameTree::add_geodetic(const std::string& name, double latitude, double longitude, double height) {
    check_new_name(name, contains(name));
    if (!is_geodetic(latitude, longitude, height))
        throw std::invalid_argument("frame " + name +
                                    " has an origin that is not on Earth: expected latitude within +-pi/2 rad, "
                                    "finite longitude and height");
    Vector3d origin;
    std::vector<double> axes(9);  // columns east, north, up; row by row
    GeographicLib::Geocentric::WGS84().Forward(latitude / degree, longitude / degree, height, origin.x(), origin.y(),
                                               origin.z(), axes);
    Pose to_earth;
    write({Matrix3d::Map(axes.data()).transpose(), origin}, to_earth.rotation, to_earth.translation);
    frames_.emplace(name, Frame{name, Pose{}});
    origins_.emplace(name, to_earth);
}

bool FrameTree::contains(const std::string& name) const { return frames_.count(name) != 0; }

const FrameTree::Frame* FrameTree::require(const char* name, plr_error* error) const {
    if (name == nullptr) {
        tell(error, PLR_E_DATA, "frames: the name of a frame is NULL");
        return nullptr;
    }
    const auto found = frames_.find(std::string_view(name));
    if (found != frames_.end()) return &found->second;
    std::string known;
    for (const auto& [other, frame] : frames_)
        if (!other.empty()) known += (known.empty() ? "" : ", ") + other;
    tell(error, PLR_E_DATA,
         "no " + show(name) + " in this graph; it has " + (known.empty() ? "the root frame only" : known));
    return nullptr;
}

plr_status FrameTree::transform(void* context, const char* from, const char* to, std::int64_t, plr_frame_pose* out,
                                plr_error* error) noexcept {
    const auto& self = *static_cast<const FrameTree*>(context);
    return answer(error, [&](plr_error& own) -> plr_status {
        if (out == nullptr || out->struct_size < first_size<plr_frame_pose>)
            return tell(&own, PLR_E_DATA, "frames: transform has nowhere to write");
        const Frame* const source = self.require(from, &own);
        const Frame* const target = source == nullptr ? nullptr : self.require(to, &own);
        if (target == nullptr) return PLR_E_DATA;
        if (source == target) {  // exactly nothing, not nearly
            write({Matrix3d::Identity(), Vector3d::Zero()}, out->rotation, out->translation);
            return PLR_OK;
        }
        Isometry in = read(source->to_anchor);
        if (source->anchor != target->anchor) {
            const auto source_origin = self.origins_.find(source->anchor);
            const auto target_origin = self.origins_.find(target->anchor);
            if (source_origin == self.origins_.end() || target_origin == self.origins_.end())
                return tell(&own, PLR_E_DATA,
                            show(from) + " and " + show(to) +
                                " are not joined: one stands on Earth, the other below the root frame");
            // First between the two origins: only there do numbers as large as the Earth's radius cancel.
            in = compose(between(read(source_origin->second), read(target_origin->second)), in);
        }
        write(between(in, read(target->to_anchor)), out->rotation, out->translation);
        return PLR_OK;
    });
}

const FrameTree::Pose* FrameTree::require_earth(const char* name, const Frame& frame, plr_error* error) const {
    const auto origin = origins_.find(frame.anchor);
    if (origin != origins_.end()) return &origin->second;
    tell(error, PLR_E_DATA, show(name) + " has no geodetic origin, neither of its own nor of a frame above it");
    return nullptr;
}

plr_status FrameTree::from_geodetic(void* context, const char* name, const double geodetic[3], double cartesian[3],
                                    plr_error* error) noexcept {
    const auto& self = *static_cast<const FrameTree*>(context);
    return answer(error, [&](plr_error& own) -> plr_status {
        if (geodetic == nullptr || cartesian == nullptr)
            return tell(&own, PLR_E_DATA, "frames: from_geodetic has no position");
        const Frame* const frame = self.require(name, &own);
        const Pose* const to_earth = frame == nullptr ? nullptr : self.require_earth(name, *frame, &own);
        if (to_earth == nullptr) return PLR_E_DATA;
        if (!is_geodetic(geodetic[0], geodetic[1], geodetic[2]))
            return tell(&own, PLR_E_DATA,
                        "frames: not a geodetic position: expected latitude within +-pi/2 rad, finite longitude "
                        "and height, got " +
                            std::to_string(geodetic[0]) + ", " + std::to_string(geodetic[1]) + ", " +
                            std::to_string(geodetic[2]));
        Vector3d on_earth;
        GeographicLib::Geocentric::WGS84().Forward(geodetic[0] / degree, geodetic[1] / degree, geodetic[2],
                                                   on_earth.x(), on_earth.y(), on_earth.z());
        Vector3d::Map(cartesian) = enter(read(frame->to_anchor), enter(read(*to_earth), on_earth));
        return PLR_OK;
    });
}

plr_status FrameTree::to_geodetic(void* context, const char* name, const double cartesian[3], double geodetic[3],
                                  plr_error* error) noexcept {
    const auto& self = *static_cast<const FrameTree*>(context);
    return answer(error, [&](plr_error& own) -> plr_status {
        if (geodetic == nullptr || cartesian == nullptr)
            return tell(&own, PLR_E_DATA, "frames: to_geodetic has no position");
        const Frame* const frame = self.require(name, &own);
        const Pose* const to_earth = frame == nullptr ? nullptr : self.require_earth(name, *frame, &own);
        if (to_earth == nullptr) return PLR_E_DATA;
        const Vector3d position = Vector3d::Map(cartesian);
        if (!position.allFinite())
            return tell(&own, PLR_E_DATA, "frames: to_geodetic of a position that is not finite");
        const Vector3d on_earth = leave(read(*to_earth), leave(read(frame->to_anchor), position));
        double latitude = 0, longitude = 0;
        GeographicLib::Geocentric::WGS84().Reverse(on_earth.x(), on_earth.y(), on_earth.z(), latitude, longitude,
                                                   geodetic[2]);
        geodetic[0] = latitude * degree;
        geodetic[1] = longitude * degree;
        return PLR_OK;
    });
}

}  // namespace pelorus::host
