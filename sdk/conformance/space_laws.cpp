#include "space_laws.hpp"

#include <cmath>
#include <map>
#include <set>

#include <pelorus/space.hpp>

namespace pelorus::conformance {

namespace {

struct Known {
    int rank;  ///< where it stands among its own family
    const char* unit;
};

/// The components of states in canonical order.
const std::map<std::string, Known>& kinematic() {
    static const std::map<std::string, Known> all = [] {
        std::map<std::string, Known> known;
        const char* const names[] = {"position", "velocity", "acceleration", "jerk"};
        const char* const units[] = {"m", "m/s", "m/s2", "m/s3"};
        const char* const axes[] = {".x", ".y", ".z"};
        for (int order = 0; order < 4; ++order)
            for (int axis = 0; axis < 3; ++axis)
                known[std::string(names[order]) + axes[axis]] = {order * 3 + axis, units[order]};
        return known;
    }();
    return all;
}

/// Of measurements.
const std::map<std::string, Known>& measured() {
    static const std::map<std::string, Known> all{{"range", {0, "m"}},
                                                  {"range_rate", {1, "m/s"}},
                                                  {"azimuth", {2, "rad"}},
                                                  {"elevation", {3, "rad"}},
                                                  {"zenith", {3, "rad"}}};
    return all;
}

void check_order(const Space& space, const std::map<std::string, Known>& family, const std::string& what,
                 const char* order, std::vector<std::string>& faults) {
    int last = -1;
    std::string before;
    for (const Component& component : space.components()) {
        const auto known = family.find(component.name);
        if (known == family.end()) continue;
        if (component.unit != known->second.unit)
            faults.push_back(what + ": " + component.name + " has the unit `" + component.unit + "`, expected `" +
                             known->second.unit + "`");
        if (known->second.rank < last)
            faults.push_back(what + ": " + component.name + " stands after " + before + "; the order is " + order);
        last = known->second.rank;
        before = component.name;
    }
}

void check_component(const Component& component, const std::string& what, Priors priors,
                     std::vector<std::string>& faults) {
    const std::string name = what + ": " + component.name;
    if (component.angle && component.unit != "rad")
        faults.push_back(name + " is an angle and has the unit `" + component.unit + "`, expected `rad`");
    if (component.name == "azimuth" && !component.angle)
        faults.push_back(name + " is not marked as an angle (PLR_COMPONENT_ANGLE): its differences would not wrap");
    const double deviation = component.prior_deviation;
    if (!std::isfinite(component.prior_mean)) faults.push_back(name + " has a prior mean that is not finite");
    if (priors == Priors::positive && !(deviation > 0 && std::isfinite(deviation)))
        faults.push_back(name + " has the prior deviation " + std::to_string(deviation) +
                         ", expected a finite one above 0: filters start from it where nothing is known");
    if (priors == Priors::zero && deviation != 0)
        faults.push_back(name + " has the prior deviation " + std::to_string(deviation) +
                         ", expected 0 of a measurement");
}

}  // namespace

std::vector<std::string> faults_of(const plr_space* raw, const std::string& what, Priors priors) {
    if (raw == nullptr) return {what + " is NULL"};
    if (raw->struct_size < sizeof(plr_space)) return {what + ": struct_size is too small"};
    if (raw->size == 0 || raw->components == nullptr) return {what + " has no components"};
    if (raw->components->struct_size < sizeof(plr_component)) return {what + ": components: struct_size is too small"};
    const auto* at = reinterpret_cast<const unsigned char*>(raw->components);
    for (std::uint32_t i = 0; i < raw->size; ++i, at += raw->components->struct_size) {
        const auto& component = *reinterpret_cast<const plr_component*>(at);
        if (component.name == nullptr || *component.name == 0)
            return {what + ": component " + std::to_string(i) + " has no name"};
        if (component.unit == nullptr) return {what + ": " + component.name + " has no unit (\"\" if it has none)"};
    }
    const Space space(*raw);
    std::vector<std::string> faults;
    std::set<std::string> names;
    for (const Component& component : space.components()) {
        if (!names.insert(component.name).second) faults.push_back(what + ": " + component.name + " stands twice");
        check_component(component, what, priors, faults);
    }
    check_order(space, kinematic(), what, "positions, velocities, accelerations, each x, y, z", faults);
    check_order(space, measured(), what, "range, range_rate, azimuth, elevation or zenith", faults);
    return faults;
}

int leading_positions(const plr_space& raw) {
    const Space space(raw);
    static const char* const names[] = {"position.x", "position.y", "position.z"};
    int count = 0;
    while (count < 3 && count < space.size() && space[count].name == names[count]) ++count;
    return count;
}

}  // namespace pelorus::conformance
