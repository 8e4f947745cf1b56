/// Spaces that own their components, and the names that Pelorus uses everywhere.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include <pelorus/abi/space.h>
#include <pelorus/failure.hpp>

namespace pelorus {

struct Component {
    std::string name, unit;
    double prior_mean = 0;
    double prior_deviation = 0;  ///< states: > 0; measurements: 0
    bool angle = false;          ///< differences wrap to (-pi, pi]
};

/// An owning plr_space. Moving and copying keep c() valid for the new object.
class Space {
public:
    Space() { rebuild(); }
    Space(std::vector<Component> components) : components_(std::move(components)) { rebuild(); }
    explicit Space(const plr_space& from) {
        const char* at = reinterpret_cast<const char*>(from.components);
        for (std::uint32_t i = 0; i < from.size; ++i) {
            const auto& c = *reinterpret_cast<const plr_component*>(at);
            components_.push_back(
                {c.name, c.unit, c.prior_mean, c.prior_deviation, (c.flags & PLR_COMPONENT_ANGLE) != 0});
            at += c.struct_size;
        }
        rebuild();
    }
    Space(const Space& other) : components_(other.components_) { rebuild(); }
    // Names stay where they are when a vector changes hands: nothing is allocated, so nothing can fail.
    Space(Space&& other) noexcept : components_(std::move(other.components_)), raw_(std::move(other.raw_)) {
        point();
        other.components_.clear();
        other.raw_.clear();
        other.point();
    }
    Space& operator=(Space other) noexcept {
        components_.swap(other.components_);
        raw_.swap(other.raw_);
        point();
        return *this;
    }
    ~Space() = default;

    const plr_space* c() const noexcept { return &space_; }
    int size() const noexcept { return static_cast<int>(components_.size()); }
    const Component& operator[](int i) const { return components_[static_cast<std::size_t>(i)]; }
    const std::vector<Component>& components() const noexcept { return components_; }
    /// Index of the component of that name, or -1.
    int index(const std::string& name) const noexcept {
        for (std::size_t i = 0; i < components_.size(); ++i)
            if (components_[i].name == name) return static_cast<int>(i);
        return -1;
    }
    /// Same names and units in the same order.
    bool same(const Space& other) const noexcept {
        if (components_.size() != other.components_.size()) return false;
        for (std::size_t i = 0; i < components_.size(); ++i)
            if (components_[i].name != other.components_[i].name || components_[i].unit != other.components_[i].unit)
                return false;
        return true;
    }
    /// `position.x [m], position.y [m]`, for messages.
    std::string text() const {
        std::string out;
        for (const Component& component : components_)
            out += (out.empty() ? "" : ", ") + component.name + " [" + component.unit + "]";
        return out;
    }

private:
    void rebuild() {
        raw_.clear();
        for (const Component& component : components_)
            raw_.push_back({sizeof(plr_component), component.angle ? std::uint32_t{PLR_COMPONENT_ANGLE} : 0u,
                            component.name.c_str(), component.unit.c_str(), component.prior_mean,
                            component.prior_deviation});
        point();
    }
    void point() noexcept { space_ = {sizeof(plr_space), static_cast<std::uint32_t>(raw_.size()), raw_.data()}; }
    std::vector<Component> components_;
    std::vector<plr_component> raw_;
    plr_space space_{};
};

/// Throws ArgumentError unless a space that a class answers has the size that its template arguments promise.
inline void expect_size(const Space& space, int size, const char* function) {
    if (space.size() != size)
        throw ArgumentError(std::string(function) + " has " + std::to_string(space.size()) +
                            " components, the class says " + std::to_string(size));
}

/// Positions, then velocities, then accelerations, then jerks, over x, y, z: the canonical order.
/// `deviations` holds a prior deviation for each derivative present (m, m/s, m/s2, m/s3).
inline Space kinematic_space(int dimension, const std::vector<double>& deviations) {
    static const char* const names[] = {"position", "velocity", "acceleration", "jerk"};
    static const char* const units[] = {"m", "m/s", "m/s2", "m/s3"};
    static const char* const axes[] = {".x", ".y", ".z"};
    std::vector<Component> components;
    for (std::size_t order = 0; order < deviations.size(); ++order)
        for (int axis = 0; axis < dimension; ++axis)
            components.push_back({std::string(names[order]) + axes[axis], units[order], 0.0, deviations[order], false});
    return Space(std::move(components));
}

/// Cartesian position of a given dimension, as sensors look at it.
inline Space position_space(int dimension) { return kinematic_space(dimension, {0.0}); }

}  // namespace pelorus
