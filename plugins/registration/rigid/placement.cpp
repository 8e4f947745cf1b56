#include "placement.hpp"

#include <cmath>

#include <GeographicLib/LocalCartesian.hpp>
#include <pelorus/failure.hpp>

#include "../../common/sensing/spherical_model.hpp"

namespace rigid {

namespace {

/// Out of east, north, up at `to`, into east, north, up at `from` (WGS84).
/// Source: C. F. F. Karney, GeographicLib, LocalCartesian.
Motion between_sites(const std::vector<double>& from, const std::vector<double>& to) {
    const double degrees = 45.0 / std::atan(1.0);
    const GeographicLib::LocalCartesian axes(from[0] * degrees, from[1] * degrees, from[2]);
    std::vector<double> rotation(9);
    Motion out;
    axes.Forward(to[0] * degrees, to[1] * degrees, to[2], out.translation(0), out.translation(1), out.translation(2),
                 rotation);
    out.rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rotation.data());
    return out;
}

void check_site(const std::optional<std::vector<double>>& site, const char* name) {
    if (site && !(std::abs((*site)[0]) <= 2 * std::atan(1.0)))
        throw pelorus::ParameterError(name, "has a latitude beyond 90 deg (a number without a unit is in rad)");
}

}  // namespace

Motion Motion::inverse() const {
    Motion out;
    out.rotation = rotation.transpose();
    out.translation = -(out.rotation * translation);
    return out;
}

bool Motion::keeps_the_plane() const {
    const double most = 1e-12;
    return std::abs(rotation(0, 2)) <= most && std::abs(rotation(1, 2)) <= most && std::abs(rotation(2, 0)) <= most &&
           std::abs(rotation(2, 1)) <= most && rotation(2, 2) > 0;
}

Matrix<3> rotation_of_attitude(const Vector<3>& attitude) {
    return spherical::rotation(attitude(0), attitude(1), attitude(2));
}

Matrix<3> rotation_of_quaternion(const Vector<4>& quaternion) {
    const double w = quaternion(0), x = quaternion(1), y = quaternion(2), z = quaternion(3);
    Matrix<3> r;
    r << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),   //
        2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
    return r;
}

Motion Placement::into() const {
    if (attitude && quaternion)
        throw pelorus::ParameterError("quaternion", "is given together with `attitude`; give one of them");
    if (from_site.has_value() != to_site.has_value())
        throw pelorus::ParameterError(from_site ? "to_site" : "from_site", "is required: a site is told from another");
    check_site(from_site, "from_site");
    check_site(to_site, "to_site");
    Motion out;  // of the described axes into the surrounding ones, which is how they are told
    if (attitude) out.rotation = rotation_of_attitude(Eigen::Map<const Vector<3>>(attitude->data()));
    if (quaternion) {
        const Vector<4> q = Eigen::Map<const Vector<4>>(quaternion->data());
        if (!(std::abs(q.norm() - 1) <= 1e-6))
            throw pelorus::ParameterError("quaternion", "has the norm " + std::to_string(q.norm()) + ", a rotation 1");
        out.rotation = rotation_of_quaternion(q / q.norm());
    }
    if (translation) out.translation = Eigen::Map<const Vector<3>>(translation->data());
    if (from_site) {
        const Motion site = between_sites(*from_site, *to_site);
        out.translation = site(out.translation);
        out.rotation = (site.rotation * out.rotation).eval();
    }
    return out.inverse();
}

}  // namespace rigid
