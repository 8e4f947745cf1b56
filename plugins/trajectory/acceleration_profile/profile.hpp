/// Motion under an acceleration that is piecewise linear in time, in closed form: in a piece that begins with p0, v0, a0 and
/// whose acceleration changes by j a second, t into it,
///     a = a0 + j t,   v = v0 + a0 t + j t^2/2,   p = p0 + v0 t + a0 t^2/2 + j t^3/6.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <pelorus/failure.hpp>

namespace acceleration_profile {

using Axes = std::array<double, 3>;  // m, m/s or m/s2; axes that are not used are 0

/// Acceleration at a time (s). Two with the same time make a jump.
struct Knot {
    double time = 0;
    Axes acceleration{};
};

struct Motion {
    Axes position{}, velocity{}, acceleration{};
};

class Profile {
public:
    /// Throws ParameterError("acceleration[i].time") where times descend, or where one stands three times.
    void build(const Axes& position, const Axes& velocity, const std::vector<Knot>& knots) {
        for (std::size_t i = 1; i < knots.size(); ++i) {
            const std::string name = "acceleration[" + std::to_string(i) + "].time";
            if (knots[i].time < knots[i - 1].time)
                throw pelorus::ParameterError(name, "is before the one above it; rows ascend in time");
            if (i > 1 && knots[i].time == knots[i - 2].time)
                throw pelorus::ParameterError(name, "stands a third time; a jump takes two rows");
        }
        Piece piece{0, {position, velocity, knots.empty() ? Axes{} : knots.front().acceleration}, {}};
        pieces_.push_back(piece);
        for (std::size_t i = 0; i < knots.size(); ++i) {
            piece.start = at(pieces_.back(), knots[i].time - pieces_.back().begin);
            piece.begin = knots[i].time;
            piece.start.acceleration = knots[i].acceleration;
            piece.jerk = {};
            const bool has_next = i + 1 < knots.size() && knots[i + 1].time > knots[i].time;
            for (std::size_t k = 0; has_next && k < piece.jerk.size(); ++k)
                piece.jerk[k] =
                    (knots[i + 1].acceleration[k] - knots[i].acceleration[k]) / (knots[i + 1].time - knots[i].time);
            pieces_.push_back(piece);
        }
    }

    /// t in s, t >= 0. Right-continuous: at a jump, what comes after it.
    Motion at(double t) const noexcept {
        std::size_t i = pieces_.size() - 1;
        while (i > 0 && pieces_[i].begin > t) --i;
        return at(pieces_[i], t - pieces_[i].begin);
    }

private:
    struct Piece {
        double begin;  ///< s
        Motion start;
        Axes jerk;  ///< m/s3
    };

    static Motion at(const Piece& piece, double t) noexcept {
        Motion out = piece.start;
        for (std::size_t k = 0; k < piece.jerk.size(); ++k) {
            const double v = piece.start.velocity[k], a = piece.start.acceleration[k], j = piece.jerk[k];
            out.acceleration[k] = a + j * t;
            out.velocity[k] = v + t * (a + j * t / 2);
            out.position[k] += t * (v + t * (a / 2 + j * t / 6));
        }
        return out;
    }

    std::vector<Piece> pieces_;
};

}  // namespace acceleration_profile
