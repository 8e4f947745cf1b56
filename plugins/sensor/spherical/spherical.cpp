// sensor.spherical: measures range and two angles from where and how it is mounted. See README.md.
#include "../../common/batches/batches.hpp"
#include "../../common/sensing/angles.hpp"
#include "../../common/sensing/mounted_sensor.hpp"
#include "../../common/variants/variants.hpp"
#include "spherical_kernels.hpp"

#include <array>

#include <pelorus/batch_model.hpp>

namespace {

using batches::at;
using sensing::Angle;
using spherical_kernels::Fault;
using spherical_kernels::Kernels;
using spherical_kernels::Mounting;
using spherical_kernels::TriplesIn;
using spherical_kernels::TriplesOut;

TriplesIn triples(const plr_const_view& view, std::int64_t first = 0, bool one_point = false) noexcept {
    return {at(view, first), view.item_stride, one_point ? 0 : view.col_stride};
}
TriplesOut triples(const plr_view& view, std::int64_t first = 0) noexcept {
    return {at(view, first), view.item_stride, view.col_stride};
}

/// So many items are worked out before any is judged.
constexpr std::int64_t block = 64;
using Faults = std::array<Fault, block>;

/// Throws what a fault means.
void require(Fault fault) {
    if (fault == Fault::none) return;
    if (fault == Fault::not_finite) throw pelorus::NumericError("a result is not finite");
    sensing::refuse_slope(fault == Fault::at_sensor);
}

plr_status settled(const plr_call& call, std::int64_t items, const Faults& faults) {
    return pelorus::for_items(call, items, [&](std::int64_t i) { require(faults[static_cast<std::size_t>(i)]); });
}

enum class Range { own, passive };

/// What it is and does; all but the noise, whose length differs among the classes.
template <class Plugin> void describe_reading(pelorus::Describe<Plugin>& plugin);

constexpr const char *units = "m, rad, rad", *initial_noise = "[10 m, 1 mrad, 1 mrad]",
                     *measured = "range, azimuth and elevation or zenith";

/// Whole batches are worked out over lanes: measure, jacobian and residual of the table are those here.
struct Spherical : sensing::MountedSensor<Spherical, 3, 3> {
    static constexpr std::uint32_t flags = sensing::mounted_flags | PLR_SENSOR_CAN_INVERT;

    Angle angle = Angle::elevation;
    Range range = Range::own;
    pelorus::ConversionMoments moments = pelorus::ConversionMoments::exact;

    static void describe(pelorus::Describe<Spherical>& plugin) {
        describe_reading(plugin);
        describe_common(plugin, units, initial_noise, measured);
    }

    pelorus::Space measurement_space() const {
        return pelorus::Space(
            {sensing::range_component(), sensing::azimuth_component(), sensing::angle_component(angle)});
    }
    // One point, as the author layer asks for it.
    Measurement measure(const Cartesian& x, const Look& look) const;
    Jacobian jacobian(const Cartesian& x, const Look& look) const;
    Inverse converted(const Measurement& z, const Noise& noise) const {
        const auto point = sensing::unbiased(z, noise, angle, moments);
        return {point.mean, point.covariance};
    }

    static const plr_sensor& table() noexcept;
    plr_status measure_batch(const plr_call& call, const plr_sensor_measure& args) const;
    plr_status jacobian_batch(const plr_call& call, const plr_sensor_jacobian& args) const;
    plr_status residual_batch(const plr_call& call, const plr_sensor_residual& args) const;

private:
    Mounting mounting(const pelorus::Look& look) const;
    /// Calls body(first item, items, how the sensor stands) for all items at once, or, where each has inputs of its own, for one
    /// after the other.
    template <class Body> void for_mountings(const plr_call& call, std::int64_t count, Body&& body) const;

    lanes::ByItems<const Kernels*> kernels_{&spherical_kernels::kernels(lanes::InstructionSet::baseline),
                                            &spherical_kernels::kernels(lanes::best_instruction_set())};
};

const plr_sensor& Spherical::table() noexcept {
    static const plr_sensor own = [] {
        plr_sensor t = Base::table();
        t.measure = &pelorus::detail::forward<Spherical, plr_sensor_measure, &Spherical::measure_batch>;
        t.jacobian = &pelorus::detail::forward<Spherical, plr_sensor_jacobian, &Spherical::jacobian_batch>;
        t.residual = &pelorus::detail::forward<Spherical, plr_sensor_residual, &Spherical::residual_batch>;
        return t;
    }();
    return own;
}

Mounting Spherical::mounting(const pelorus::Look& look) const {
    const auto here = pose(look);
    const Measurement off = bias(look);
    Mounting out{};
    std::copy_n(here.rotation.data(), 9, out.rotation);
    std::copy_n(here.position.data(), 3, out.position);
    std::copy_n(off.data(), 3, out.bias);
    out.is_zenith = angle == Angle::zenith;
    return out;
}

Spherical::Measurement Spherical::measure(const Cartesian& x, const Look& look) const {
    Measurement out;
    Fault fault = Fault::none;
    kernels_.few->measure(mounting(look), 1, 1, {x.data(), 0, 0}, {out.data(), 0, 0}, &fault);
    require(fault);
    return out;
}

Spherical::Jacobian Spherical::jacobian(const Cartesian& x, const Look& look) const {
    Jacobian out;
    Fault fault = Fault::none;
    kernels_.few->differentiate(mounting(look), 1, {x.data(), 0, 0}, {out.data(), 0, 0}, &fault);
    require(fault);
    return out;
}

template <class Body> void Spherical::for_mountings(const plr_call& call, std::int64_t count, Body&& body) const {
    const std::int64_t together = call.input_stride == 0 || call.inputs == nullptr ? count : 1;
    for (std::int64_t first = 0; first < count; first += together)
        body(first, together, mounting(pelorus::Look{&call, first}));
}

plr_status Spherical::measure_batch(const plr_call& call, const plr_sensor_measure& args) const {
    const std::int64_t points = args.out.cols;
    batches::expect_packed(args.cartesian, 3, points, args.out.count, "cartesian");
    batches::expect_packed(args.out, 3, points, args.out.count, "out");
    const auto body = [&](const plr_call& here, std::int64_t first, std::int64_t items) {
        Faults faults{};
        for_mountings(here, items, [&](std::int64_t from, std::int64_t some, const Mounting& mounted) {
            kernels_(some * points)
                ->measure(mounted, some, points, triples(args.cartesian, first + from), triples(args.out, first + from),
                          faults.data() + from);
        });
        return settled(here, items, faults);
    };
    return batches::in_blocks(call, args.out.count, body, block);
}

plr_status Spherical::jacobian_batch(const plr_call& call, const plr_sensor_jacobian& args) const {
    batches::expect_packed(args.cartesian, 3, 1, args.out.count, "cartesian");
    batches::expect_packed(args.out, 3, 3, args.out.count, "out");
    const auto body = [&](const plr_call& here, std::int64_t first, std::int64_t items) {
        Faults faults{};
        for_mountings(here, items, [&](std::int64_t from, std::int64_t some, const Mounting& mounted) {
            kernels_(some)->differentiate(mounted, some, triples(args.cartesian, first + from),
                                          triples(args.out, first + from), faults.data() + from);
        });
        return settled(here, items, faults);
    };
    return batches::in_blocks(call, args.out.count, body, block);
}

plr_status Spherical::residual_batch(const plr_call& call, const plr_sensor_residual& args) const {
    const std::int64_t count = args.out.count, points = args.out.cols;
    const bool one_reference = args.reference.cols == 1;
    batches::expect_packed(args.measurement, 3, points, count, "measurement");
    batches::expect_packed(args.reference, 3, one_reference ? 1 : points, count, "reference");
    batches::expect_packed(args.out, 3, points, count, "out");
    const auto body = [&](const plr_call& here, std::int64_t first, std::int64_t items) {
        Faults faults{};
        kernels_(items * points)
            ->subtract(items, points, triples(args.measurement, first), triples(args.reference, first, one_reference),
                       triples(args.out, first), faults.data());
        return settled(here, items, faults);
    };
    return batches::in_blocks(call, count, body, block);
}

/// The angles alone. `noise` and `bias` have three values all the same, of which those of the range are left out.
struct Passive : sensing::MountedSensor<Passive, 2, 3> {
    static constexpr std::uint32_t flags = sensing::mounted_flags;
    static constexpr int bias_offset = 1;

    Angle angle = Angle::elevation;
    Range range = Range::passive;
    pelorus::ConversionMoments moments = pelorus::ConversionMoments::exact;  // of no point: none is converted
    pelorus::Vector<3> all_deviations;

    static void describe(pelorus::Describe<Passive>& plugin) {
        describe_reading(plugin);
        plugin.parameter("noise", &Passive::all_deviations)
            .unit(units)
            .initially(initial_noise)
            .above(0.0)
            .doc(std::string("deviations of ") + measured + "; for scans that carry no covariances");
        describe_law(plugin);
        describe_inputs(plugin, units, 3, measured);
    }

    void setup(const pelorus::Setup& setup) {
        deviations = all_deviations.tail<2>();
        MountedSensor::setup(setup);
    }
    pelorus::Space measurement_space() const {
        return pelorus::Space({sensing::azimuth_component(), sensing::angle_component(angle)});
    }
    Measurement seen(const Cartesian& local) const { return sensing::seen(local, angle).tail<2>(); }
    Jacobian slope(const Cartesian& local) const { return sensing::slope(local, angle).bottomRows<2>(); }
};

template <class Plugin> void describe_reading(pelorus::Describe<Plugin>& plugin) {
    plugin.title("Range, azimuth and elevation or zenith")
        .purpose(
            "A radar, lidar or sonar that measures range and two angles from its mount. Single measurements are "
            "converted to Cartesian points without bias, with the exact second moments of their errors.")
        .equation(
            "(x, y, z) = R' (p - position), R = Rz(yaw) Ry(pitch) Rx(roll); range = sqrt(x^2 + y^2 + z^2), azimuth = "
            "atan2(y, x), elevation = atan2(z, sqrt(x^2 + y^2)), zenith = pi/2 - elevation; bias and noise are added")
        .source(
            "L. Mo, X. Song, Y. Zhou, Z. K. Sun, Y. Bar-Shalom, Unbiased converted measurements for tracking, IEEE "
            "Transactions on Aerospace and Electronic Systems 34(3), 1023-1027, 1998; S. Bordonaro, P. Willett, Y. "
            "Bar-Shalom, Decorrelated unbiased converted measurement Kalman filter, ibid. 50(2), 1431-1444, 2014");
    sensing::describe_angle(plugin, &Plugin::angle);
    sensing::describe_moments(plugin, &Plugin::moments);
    plugin.parameter("range", &Plugin::range)
        .initially("own")
        .choices(
            {{"own", "the sensor measures the range itself"},
             {"passive", "it measures angles alone, as sensor.bearings does; a single measurement tells no position"}})
        .doc("whether the range is measured");
}

/// Chooses the class by `range`.
struct Plugin : variants::Variants<Spherical> {
    static plr_instance create(const pelorus::Setup& setup) {
        return parameters(setup).range == Range::own ? pelorus::instantiate<Spherical>(setup)
                                                     : pelorus::instantiate<Passive>(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(Plugin, "sensor.spherical");
