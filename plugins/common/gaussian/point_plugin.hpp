/// An estimator plugin that is a point filter: what a rule has to add is its name, its parameters and its points.
///
///     class Mine : public gaussian::PointPlugin<Mine> {
///     public:
///         static void describe(pelorus::Describe<Mine>& plugin);   // calls describe_parts
///         gaussian::PointRule rule(int n) const;
///     };
#pragma once

#include "point_filter.hpp"

#include <cstring>

namespace gaussian {

template <class Derived> class PointPlugin : public pelorus::Estimator<Derived>, public PointFilter {
public:
    void setup(const pelorus::Setup& setup) {
        setup_filter(setup, form, this->info);
        setup_points(static_cast<const Derived&>(*this).rule(static_cast<int>(n_)), component_order, this->info);
    }
    const void* extension(const char* id) const noexcept {
        return std::strcmp(id, PLR_ESTIMATOR_MIX) == 0 ? mix_table<Derived>() : nullptr;
    }

    Form form = Form::square_root;
    ComponentOrder component_order = ComponentOrder::state;

protected:
    static void describe_parts(pelorus::Describe<Derived>& plugin) {
        plugin.slot("motion", "motion", 1, 1, "how the state evolves");
        plugin.slot("sensors", "sensor", 1, -1, "what measures it; a scan meets its sensor by name");
        plugin.parameter("form", &Derived::form)
            .initially("square_root")
            .choices({{"covariance", "records hold covariances, whose factors are found at each step"},
                      {"square_root", "records hold factors of covariances, which no rounding makes indefinite"}})
            .doc("what is kept of a track's spread, and computed with");
        plugin.parameter("component_order", &Derived::component_order)
            .initially("state")
            .choices({{"state", "as the motion has them: positions, velocities, accelerations; fastest"},
                      {"axes", "axis by axis: position, velocity and acceleration of x, then of y, ..."}})
            .doc(
                "the order of components in which a covariance is factored: it decides where points lie on the "
                "ellipsoid, and so "
                "what a rule makes of curvature beyond its degree; linear motions and sensors do not feel it");
    }
};

}  // namespace gaussian
