#include "local_sensor.hpp"

#include <cmath>
#include <optional>

namespace rigid {

namespace {

constexpr double close = 1e-7;  ///< of metres in a kilometre, and of radians
const Vector<3> points_seen[] = {{500, 300, 200}, {-200, 700, 100}, {300, -400, 600}};

/// What stands for `name` (space.h) of a point along the sensor's axes.
std::optional<double> component(const std::string& name, const Vector<3>& p) {
    const double ground = std::hypot(p(0), p(1));
    if (name == "range") return std::hypot(ground, p(2));
    if (name == "azimuth") return std::atan2(p(1), p(0));
    if (name == "elevation") return std::atan2(p(2), ground);
    if (name == "zenith") return std::atan2(ground, p(2));
    if (name == "position.x") return p(0);
    if (name == "position.y") return p(1);
    if (name == "position.z") return p(2);
    return std::nullopt;
}

}  // namespace

bool LocalSensor::stands_there(const Motion& motion, std::int64_t time, pelorus::Caller& caller) const {
    if (!pelorus::Space(*sensor_.info().cartesian).same(pelorus::position_space(3))) return true;
    const Motion back = motion.inverse();
    std::vector<double> points, expected;
    for (const Vector<3>& point : points_seen) {
        const Vector<3> from = back(point);
        points.insert(points.end(), from.data(), from.data() + 3);
        for (const pelorus::Component& each : space_.components()) {
            const auto value = component(each.name, point);
            if (!value) return true;
            expected.push_back(*value);
        }
    }
    const std::int64_t count = static_cast<std::int64_t>(points.size()) / 3, m = space_.size();
    std::vector<double> measured(expected.size());
    auto args = pelorus::arguments<plr_sensor_measure>();
    args.cartesian = pelorus::const_view(points.data(), 3, 1, count);
    args.out = pelorus::view(measured.data(), m, 1, count);
    caller.tolerate(sensor_.call(&plr_sensor::measure, caller.begin(time, count), args),
                    "local." + sensor_.name() + ", measure");
    for (std::size_t k = 0; k < expected.size(); ++k) {
        const bool is_angle = space_[static_cast<int>(static_cast<std::int64_t>(k) % m)].angle;
        const double off = measured[k] - expected[k];
        if (!(std::fabs(is_angle ? std::remainder(off, 2 * std::acos(-1.0)) : off / 1000) < close)) return false;
    }
    return true;
}

}  // namespace rigid
