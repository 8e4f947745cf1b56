/// What sensor.spherical does to points, over lanes (plugins/common/lanes). All functions are pure, [worker, concurrent] [hot]; a
/// point's numbers are the same bytes whatever its neighbours and the instruction set.
#pragma once

#include "../../common/lanes/instruction_set.hpp"

#include <cstdint>

namespace spherical_kernels {

/// How a sensor stands and errs in a call.
struct Mounting {
    double rotation[9];  ///< along its axes -> along the frame's, column-major
    double position[3], bias[3];
    bool is_zenith;  ///< the second angle is counted from the vertical axis
};

/// Three numbers each: point p of item i begins at first + i * item_stride + p * point_stride.
struct TriplesIn {
    const double* first;
    std::int64_t item_stride, point_stride;
};
struct TriplesOut {
    double* first;
    std::int64_t item_stride, point_stride;
};

/// Why an item has no result, or not for all of its points; such points' outputs are left as they are.
enum class Fault : unsigned char { none, not_finite, at_sensor, on_axis };

/// `faults`, [items], are given as `none`.
struct Kernels {
    /// (range, azimuth, angle) + bias, angles wrapped, of points in the frame.
    void (*measure)(const Mounting& mounting, std::int64_t items, std::int64_t points, const TriplesIn& from,
                    const TriplesOut& to, Fault* faults);
    /// measurement - reference, angles wrapped.
    void (*subtract)(std::int64_t items, std::int64_t points, const TriplesIn& measurement, const TriplesIn& reference,
                     const TriplesOut& to, Fault* faults);
    /// d (range, azimuth, angle) / d point, 3 x 3, of one point an item. There is none at the sensor's place and above it.
    void (*differentiate)(const Mounting& mounting, std::int64_t items, const TriplesIn& from, const TriplesOut& to,
                          Fault* faults);
};

/// Those of an instruction set that the processor supports.
const Kernels& kernels(lanes::InstructionSet set) noexcept;

}  // namespace spherical_kernels
