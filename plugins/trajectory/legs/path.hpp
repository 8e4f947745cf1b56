/// A path of legs, each with a constant turn rate and a constant acceleration along the track, in closed form.
///
/// The direction of flight is (cos g cos h, cos g sin h, sin g) with heading h (from x towards y) and climb angle g; a leg turns
/// h at a constant rate, keeps g, and changes the speed at a constant rate. So displacements are integrals of
/// (s + a t)(cos w t, sin w t), which are elementary.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <pelorus/failure.hpp>

namespace legs {

/// State of motion on the path, units m, m/s, m/s2.
struct Motion {
    double position[3], velocity[3], acceleration[3];
    double along[3], left[3], up[3];  ///< unit vectors: of flight, horizontal to its left, normal to both
};

struct Leg {
    double duration = 0;      ///< s; infinite: the last one
    double turn_rate = 0;     ///< rad/s, positive to the left
    double acceleration = 0;  ///< m/s2 along the track
};

namespace detail {

/// Integrals over t = 0..1 of cos ut, sin ut, t cos ut, t sin ut; for small u by their series, where the closed forms cancel.
struct TurnIntegrals {
    double cosine, sine, cosine_moment, sine_moment;
    explicit TurnIntegrals(double u) noexcept {
        if (std::fabs(u) > 0.5) {
            const double c = std::cos(u), s = std::sin(u);
            cosine = s / u;
            sine = (1 - c) / u;
            cosine_moment = s / u + (c - 1) / (u * u);
            sine_moment = (s - u * c) / (u * u);
            return;
        }
        cosine = sine = cosine_moment = sine_moment = 0;
        double term = 1;  // (-1)^k u^(2k) / (2k)!
        for (int k = 0; k < 9; ++k) {
            const double even = 2 * k, odd = even + 1;
            cosine += term / odd;
            cosine_moment += term / (even + 2);
            sine += term * u / (odd * (odd + 1));
            sine_moment += term * u / (odd * (odd + 2));
            term *= -u * u / (odd * (odd + 1));
        }
    }
};

}  // namespace detail

class Path {
public:
    struct Start {
        double position[3] = {0, 0, 0};
        double speed = 0, heading = 0, climb_angle = 0;  ///< m/s (along the path), rad, rad
    };

    /// Throws ParameterError("legs") where a leg does not end later than it begins, or would end flying backwards.
    void build(const Start& start, const std::vector<Leg>& legs) {
        Piece piece{0, start, {}};
        for (std::size_t i = 0; i < legs.size(); ++i) {
            piece.leg = legs[i];
            pieces_.push_back(piece);
            const std::string name = "legs[" + std::to_string(i) + "]";
            if (!(piece.leg.duration > 0)) throw pelorus::ParameterError(name + ".duration", "must be above 0 s");
            if (std::isinf(piece.leg.duration)) {
                if (i + 1 != legs.size())
                    throw pelorus::ParameterError(name + ".duration",
                                                  "is missing; only the last leg may go on for ever");
                if (piece.leg.acceleration < 0)
                    throw pelorus::ParameterError(name + ".acceleration",
                                                  "would end below speed 0 in a leg that goes on for ever");
                return;
            }
            const double speed = piece.start.speed + piece.leg.acceleration * piece.leg.duration;
            // A leg that is meant to end at rest may miss 0 by rounding.
            if (speed < -1e-9 * (1 + piece.start.speed))
                throw pelorus::ParameterError(name + ".acceleration",
                                              "ends at speed " + std::to_string(speed) + " m/s, expected 0 or more");
            const Motion end = at(pieces_.back(), piece.leg.duration);
            piece.begin += piece.leg.duration;
            for (int k = 0; k < 3; ++k) piece.start.position[k] = end.position[k];
            piece.start.speed = speed < 0 ? 0 : speed;
            piece.start.heading += piece.leg.turn_rate * piece.leg.duration;
        }
        piece.leg = {};
        pieces_.push_back(piece);  // after the last leg straight on
    }

    /// t in s after the start, t >= 0.
    Motion at(double t) const noexcept {
        std::size_t i = pieces_.size() - 1;
        while (i > 0 && pieces_[i].begin > t) --i;
        return at(pieces_[i], t - pieces_[i].begin);
    }

private:
    struct Piece {
        double begin;  ///< s after the start
        Start start;
        Leg leg;
    };

    static Motion at(const Piece& piece, double t) noexcept {
        const Start& from = piece.start;
        const Leg& leg = piece.leg;
        const double speed = from.speed + leg.acceleration * t, heading = from.heading + leg.turn_rate * t;
        const double level = std::cos(from.climb_angle), rise = std::sin(from.climb_angle);
        const detail::TurnIntegrals turn(leg.turn_rate * t);
        const double ahead = t * (from.speed * turn.cosine + leg.acceleration * t * turn.cosine_moment);
        const double aside = t * (from.speed * turn.sine + leg.acceleration * t * turn.sine_moment);
        const double c0 = std::cos(from.heading), s0 = std::sin(from.heading);
        const double c = std::cos(heading), s = std::sin(heading);
        Motion out{};
        out.position[0] = from.position[0] + level * (ahead * c0 - aside * s0);
        out.position[1] = from.position[1] + level * (ahead * s0 + aside * c0);
        out.position[2] = from.position[2] + rise * t * (from.speed + 0.5 * leg.acceleration * t);
        const double along[3] = {level * c, level * s, rise}, left[3] = {-s, c, 0},
                     up[3] = {-rise * c, -rise * s, level};
        for (int k = 0; k < 3; ++k) {
            out.along[k] = along[k];
            out.left[k] = left[k];
            out.up[k] = up[k];
            out.velocity[k] = speed * along[k];
            out.acceleration[k] = leg.acceleration * along[k] + leg.turn_rate * speed * level * left[k];
        }
        return out;
    }

    std::vector<Piece> pieces_;
};

}  // namespace legs
