/// A path of segments in space, each with a constant acceleration or a constant turn about a fixed axis, in closed form:
///     v = v0 + a t,  p = p0 + v0 t + a t^2 / 2
///     v = c + cos(w t) u + sin(w t) k x u,  p = p0 + c t + (sin(w t) u + (1 - cos(w t)) k x u) / w
/// with w the size and k the direction of the rate of turn, c the part of v0 along k and u the rest.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <pelorus/failure.hpp>
#include <pelorus/matrix.hpp>

namespace segments {

using pelorus::Vector;

struct Motion {
    Vector<3> position, velocity, acceleration;  // m, m/s, m/s2
};

struct Segment {
    double duration = std::numeric_limits<double>::infinity();  // s
    double turn_rate = 0;                                       ///< rad/s about the vertical, positive to the left
    double loop_rate = 0;  ///< rad/s in the vertical plane of the velocity at its begin, positive upwards
    double along = 0;      ///< m/s2 along the velocity at its begin
    Vector<3> acceleration = Vector<3>::Zero();  // m/s2
};

class Path {
public:
    /// Throws ParameterError("segments[i]...") where one cannot be flown.
    void build(const Vector<3>& position, const Vector<3>& velocity, const std::vector<Segment>& segments) {
        Piece piece{0, {position, velocity, Vector<3>::Zero()}, Vector<3>::Zero()};
        for (std::size_t i = 0; i < segments.size(); ++i) {
            const std::string name = "segments[" + std::to_string(i) + "]";
            begin(piece, segments[i], name);
            pieces_.push_back(piece);
            if (std::isinf(segments[i].duration)) {
                if (i + 1 != segments.size())
                    throw pelorus::ParameterError(name + ".duration",
                                                  "is missing; only the last segment may go on for ever");
                return;
            }
            piece.start = at(piece, segments[i].duration);
            piece.begin += segments[i].duration;
        }
        piece.start.acceleration.setZero();
        piece.rate.setZero();
        pieces_.push_back(piece);  // after the last segment straight on
    }

    /// t in s after the start, t >= 0. Where one segment ends and the next begins, the acceleration is that of the next.
    Motion at(double t) const noexcept {
        std::size_t i = pieces_.size() - 1;
        while (i > 0 && pieces_[i].begin > t) --i;
        return at(pieces_[i], t - pieces_[i].begin);
    }

private:
    struct Piece {
        double begin;    ///< s
        Motion start;    ///< the acceleration is the constant one
        Vector<3> rate;  ///< of turn, rad/s; 0: none
    };

    static void begin(Piece& piece, const Segment& segment, const std::string& name) {
        const Vector<3>& v = piece.start.velocity;
        const double speed = v.norm();
        const bool turns = segment.turn_rate != 0 || segment.loop_rate != 0;
        if (turns && (segment.along != 0 || !segment.acceleration.isZero(0)))
            throw pelorus::ParameterError(name, "turns and accelerates; a segment does one or the other");
        if (segment.along != 0 && !(speed > 0))
            throw pelorus::ParameterError(name + ".along", "has no direction: the velocity is 0 where it begins");
        piece.start.acceleration = segment.acceleration;
        if (segment.along != 0) piece.start.acceleration += segment.along / speed * v;
        piece.rate = Vector<3>(0, 0, segment.turn_rate);
        if (segment.loop_rate == 0) return;
        // A turn from the velocity towards the vertical is one about velocity x vertical.
        const Vector<3> axis(v(1), -v(0), 0);
        if (!(axis.norm() > 1e-9 * speed))
            throw pelorus::ParameterError(name + ".loop_rate",
                                          "has no plane: the velocity is vertical, or 0, where it begins");
        piece.rate += segment.loop_rate * axis.normalized();
    }

    static Motion at(const Piece& piece, double t) noexcept {
        Motion out = piece.start;
        const double w = piece.rate.norm();
        if (w == 0) {
            out.velocity += t * out.acceleration;
            out.position += t * (piece.start.velocity + 0.5 * t * out.acceleration);
            return out;
        }
        const Vector<3> k = piece.rate / w, c = k.dot(piece.start.velocity) * k, u = piece.start.velocity - c;
        const Vector<3> side = k.cross(u);
        const double half = 0.5 * w * t;  // 1 - cos(w t) = 2 sin(w t / 2)^2 keeps its digits at small angles
        out.velocity = c + std::cos(w * t) * u + std::sin(w * t) * side;
        out.position += c * t + (std::sin(w * t) * u + 2 * std::sin(half) * std::sin(half) * side) / w;
        out.acceleration = piece.rate.cross(out.velocity);
        return out;
    }

    std::vector<Piece> pieces_;
};

}  // namespace segments
