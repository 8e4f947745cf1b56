/// What several sensors tell of one object at one time, each of some components of a common space.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <pelorus/small_matrix.hpp>
#include <pelorus/space.hpp>

namespace fusion {

constexpr int most_components = 12;
using Square = pelorus::small::Bounded<most_components, most_components>;
using Column = pelorus::small::Bounded<most_components, 1>;

/// One estimate or measurement: p components, which stand at `places` of the common space, and their covariance.
struct Piece {
    std::vector<int> places;
    Column mean;
    Square covariance;
};

/// What comes out, in all components of the common space.
struct Fused {
    Column mean;
    Square covariance;
};

/// The difference of two angles, in (-pi, pi].
inline double wrapped(double angle) noexcept {
    constexpr double pi = 3.14159265358979323846;
    const double rest = std::remainder(angle, 2 * pi);
    return rest <= -pi ? rest + 2 * pi : rest;
}

/// The components of several spaces, each once, in the order in which they come.
class CommonSpace {
public:
    /// Answers where the components of `space` stand. Throws PartError(slot) for a unit that another space tells otherwise.
    std::vector<int> add(const pelorus::Space& space, const std::string& slot) {
        std::vector<int> places;
        std::vector<pelorus::Component> all = space_.components();
        for (const pelorus::Component& component : space.components()) {
            const pelorus::Space so_far(all);
            places.push_back(so_far.index(component.name));
            if (places.back() < 0) {
                places.back() = so_far.size();
                all.push_back(component);
            } else if (so_far[places.back()].unit != component.unit) {
                throw pelorus::PartError(
                    slot, component.name + " is told in " + so_far[places.back()].unit + " and in " + component.unit);
            }
        }
        if (all.size() > most_components)
            throw pelorus::PartError(slot, "measures " + std::to_string(all.size()) +
                                               " different components, at most " + std::to_string(most_components) +
                                               " are possible");
        space_ = pelorus::Space(std::move(all));
        return places;
    }

    const pelorus::Space& space() const noexcept { return space_; }
    int size() const noexcept { return space_.size(); }
    double difference(int component, double a, double b) const {
        return space_[component].angle ? wrapped(a - b) : a - b;
    }
    /// A value of each component that the others are counted from: that of the first piece which tells it. False where one is told
    /// by nobody.
    [[nodiscard]] bool reference(const std::vector<Piece>& pieces, Column& out) const {
        out = Column::Constant(size(), 1, std::nan(""));
        for (const Piece& piece : pieces)
            for (std::size_t i = 0; i < piece.places.size(); ++i)
                if (double& value = out(piece.places[i], 0); std::isnan(value))
                    value = piece.mean(static_cast<Eigen::Index>(i), 0);
        return pelorus::small::all_finite(out);
    }
    /// reference + step, angles in (-pi, pi].
    void advance(const Column& reference, const Column& step, Column& out) const {
        out = reference;
        for (int c = 0; c < size(); ++c) {
            out(c, 0) += step(c, 0);
            if (space_[c].angle && std::abs(out(c, 0)) > 3.14159265358979323846) out(c, 0) = wrapped(out(c, 0));
        }
    }

private:
    pelorus::Space space_;
};

}  // namespace fusion
