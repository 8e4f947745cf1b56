// The kernels over lanes, compiled once for each instruction set. Includes nothing that has inline functions of its own: see
// plugins/common/lanes/pack.hpp.
#include "../../common/lanes/angles.hpp"
#include "spherical_kernels.hpp"

namespace spherical_kernels {

namespace PELORUS_LANES {

namespace {

using namespace lanes;

/// What stands in the lanes without a point.
const double nothing[3] = {};

/// Goes through the points of all items, as many at once as there are lanes.
class Walk {
public:
    Walk(std::int64_t items, std::int64_t points) noexcept : items_(items), points_(points) { advance(); }
    bool is_left() const noexcept { return count_ > 0; }
    void next() noexcept { advance(); }
    /// The item of a lane; -1: none.
    std::int64_t item(int lane) const noexcept { return lane < count_ ? item_of_[lane] : -1; }

    void load(const TriplesIn& from, Pack* to) const noexcept {
        const double* at[width];
        for (int lane = 0; lane < width; ++lane)
            at[lane] = lane < count_
                           ? from.first + item_of_[lane] * from.item_stride + point_of_[lane] * from.point_stride
                           : nothing;
        lanes::load(at, Fixed<3>{}, to);
    }
    /// Stores the numbers of all points but those that are left out and those that are not finite, which it notes.
    template <int Count>
    void settle(const Pack* from, Fixed<Count> count, const TriplesOut& to, Mask left_out,
                Fault* faults) const noexcept {
        Pack check{};
        for (int e = 0; e < count; ++e) check += 0.0 * from[e];
        left_out |= ~(check == 0.0);
        double* at[width];
        for (int lane = 0; lane < width; ++lane) {
            const bool is_stored = lane < count_ && left_out[lane] == 0;
            at[lane] =
                is_stored ? to.first + item_of_[lane] * to.item_stride + point_of_[lane] * to.point_stride : nullptr;
            if (lane < count_ && !is_stored) faults[item_of_[lane]] = Fault::not_finite;
        }
        lanes::store(from, count, at);
    }

private:
    void advance() noexcept {
        if (points_ == 1) {
            for (int lane = 0; lane < width; ++lane) {
                item_of_[lane] = item_ + lane;
                point_of_[lane] = 0;
            }
            count_ = static_cast<int>(items_ - item_ < width ? items_ - item_ : width);
            item_ += count_;
            return;
        }
        for (count_ = 0; count_ < width && item_ < items_ && points_ > 0; ++count_) {
            item_of_[count_] = item_;
            point_of_[count_] = point_;
            if (++point_ < points_) continue;
            point_ = 0;
            ++item_;
        }
    }

    std::int64_t items_, points_, item_ = 0, point_ = 0;
    std::int64_t item_of_[width], point_of_[width];
    int count_ = 0;
};

/// A point along the sensor's axes, its distances, and the power of two by which all were multiplied, so that no square overflows
/// or vanishes.
struct Local {
    Pack p[3], ground, range, scale;

    Local(const Mounting& mounting, const Pack* point) noexcept {
        Pack from_sensor[3];
        for (int k = 0; k < 3; ++k) from_sensor[k] = point[k] - mounting.position[k];
        for (int r = 0; r < 3; ++r) {
            const double* const axis = mounting.rotation + 3 * r;
            p[r] = axis[0] * from_sensor[0] + axis[1] * from_sensor[1] + axis[2] * from_sensor[2];
        }
        scale = all(1.0);
        const Pack largest = larger(larger(absolute(p[0]), absolute(p[1])), absolute(p[2]));
        const Mask huge = largest > 1e150, tiny = largest < 1e-130;
        if (any(huge | tiny)) {
            scale = huge ? all(0x1p-600) : tiny ? all(0x1p600) : scale;
            for (Pack& each : p) each *= scale;
        }
        const Pack square = p[0] * p[0] + p[1] * p[1];
        ground = square_root(square);
        range = square_root(square + p[2] * p[2]);
    }
};

void measure(const Mounting& mounting, std::int64_t items, std::int64_t points, const TriplesIn& from,
             const TriplesOut& to, Fault* faults) noexcept {
    constexpr double half_pi = 1.57079632679489661923;
    for (Walk walk(items, points); walk.is_left(); walk.next()) {
        Pack point[3], seen[3];
        walk.load(from, point);
        const Local local(mounting, point);
        const Pack angle = arc_tangent(local.p[2], local.ground);
        seen[0] = local.range * (1.0 / local.scale) + mounting.bias[0];
        seen[1] = wrapped(arc_tangent(local.p[1], local.p[0]) + mounting.bias[1]);
        seen[2] = wrapped((mounting.is_zenith ? half_pi - angle : angle) + mounting.bias[2]);
        walk.settle(seen, Fixed<3>{}, to, Mask{}, faults);
    }
    leave_lanes();
}

void subtract(std::int64_t items, std::int64_t points, const TriplesIn& measurement, const TriplesIn& reference,
              const TriplesOut& to, Fault* faults) noexcept {
    for (Walk walk(items, points); walk.is_left(); walk.next()) {
        Pack one[3], other[3];
        walk.load(measurement, one);
        walk.load(reference, other);
        one[0] -= other[0];
        one[1] = wrapped(one[1] - other[1]);
        one[2] = wrapped(one[2] - other[2]);
        walk.settle(one, Fixed<3>{}, to, Mask{}, faults);
    }
    leave_lanes();
}

void differentiate(const Mounting& mounting, std::int64_t items, const TriplesIn& from, const TriplesOut& to,
                   Fault* faults) noexcept {
    for (Walk walk(items, 1); walk.is_left(); walk.next()) {
        Pack point[3], out[9];
        walk.load(from, point);
        const Local local(mounting, point);
        // Along the sensor's axes: where to, on the ground and in space, and by how much an angle turns a metre further.
        const Pack per_ground = 1.0 / local.ground, per_range = 1.0 / local.range;
        const Pack x = local.p[0] * per_ground, y = local.p[1] * per_ground;
        const Pack by_ground = local.scale * per_ground, by_range = local.scale * per_range;
        const Pack direction[3] = {local.p[0] * per_range, local.p[1] * per_range, local.p[2] * per_range};
        const Pack turn = mounting.is_zenith ? -by_range : by_range, rise = direction[2] * turn;
        const Pack along[9] = {direction[0], -y * by_ground, -x * rise,  //
                               direction[1], x * by_ground,  -y * rise,  //
                               direction[2], Pack{},         local.ground * per_range * turn};
        for (int c = 0; c < 3; ++c) {
            for (int r = 0; r < 3; ++r)
                out[3 * c + r] = along[r] * mounting.rotation[c] + along[3 + r] * mounting.rotation[3 + c] +
                                 along[6 + r] * mounting.rotation[6 + c];
        }
        const Mask steep = ~(local.ground > 1e-9 * local.range);
        walk.settle(out, Fixed<9>{}, to, steep, faults);
        for (int lane = 0; lane < width; ++lane)
            if (steep[lane] != 0 && walk.item(lane) >= 0)
                faults[walk.item(lane)] = local.range[lane] == 0.0 ? Fault::at_sensor : Fault::on_axis;
    }
    leave_lanes();
}

}  // namespace

extern const Kernels kernels;
const Kernels kernels{&measure, &subtract, &differentiate};

}  // namespace PELORUS_LANES

}  // namespace spherical_kernels
