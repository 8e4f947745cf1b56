// sensor.position: measures Cartesian coordinates and, where it can, velocity. See README.md.
#include "../../common/batches/batches.hpp"
#include "../../common/sensing/variants.hpp"

#include <optional>

#include <pelorus/batch_model.hpp>
#include <pelorus/per_axis.hpp>
#include <pelorus/sensor.hpp>

namespace {

struct Parameters {
    int dimension = 3;
    std::vector<double> deviation, mount;  // m
    bool velocity = false;
    std::optional<std::vector<double>> velocity_deviation;  // m/s
};

/// D axes; all components that it looks at are measured as they are: `Velocity` says whether velocity is among them.
template <int D, bool Velocity>
struct Position : pelorus::Sensor<Position<D, Velocity>, Velocity ? 2 * D : D, Velocity ? 2 * D : D>, Parameters {
    using Base = pelorus::Sensor<Position, Velocity ? 2 * D : D, Velocity ? 2 * D : D>;
    using typename Base::Cartesian;
    using typename Base::Inverse;
    using typename Base::Jacobian;
    using typename Base::Measurement;
    using typename Base::Noise;
    using typename Base::Query;
    using Look = pelorus::Look;
    static constexpr std::uint32_t flags = PLR_SENSOR_LINEAR | PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_CAN_INVERT;

    static void describe(pelorus::Describe<Position>& plugin) {
        plugin.title("Cartesian position, with or without velocity")
            .purpose(
                "Measures the coordinates of an object relative to the sensor's own position, along the axes of the "
                "frame it stands in, and by choice its velocity: a satellite receiver, a radar network's output, a "
                "camera's ground plane, a transponder that reports where and how fast it goes.")
            .equation(
                "z = p - m + w, w ~ N(0, diag(noise^2)), m the sensor's position; with velocity below it v + u, u ~ "
                "N(0, diag(velocity_noise^2))")
            .source(
                "Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation, "
                "Wiley 2001, 5.2");
        plugin.parameter("dimension", &Parameters::dimension)
            .initially("3")
            .min(1)
            .max(3)
            .doc("number of axes: x, y, z");
        plugin.parameter("noise", &Parameters::deviation)
            .unit("m")
            .initially("1 m")
            .above(0.0)
            .rows(1, 3)
            .doc("deviation of a coordinate, one value or one an axis; for scans that carry no covariances");
        plugin.parameter("position", &Parameters::mount)
            .unit("m")
            .initially("[0 m]")
            .rows(1, 3)
            .doc("where the sensor stands, from which coordinates are counted: one value an axis, or 0 for all");
        plugin.parameter("velocity", &Parameters::velocity)
            .initially("false")
            .doc("measure velocity, too, along the same axes");
        plugin.parameter("velocity_noise", &Parameters::velocity_deviation)
            .unit("m/s")
            .above(0.0)
            .rows(1, 3)
            .doc("with `velocity`: deviation of a component of it, one value or one an axis; absent: 1 m/s");
    }

    void setup(const pelorus::Setup&) {
        position_.setZero();
        position_.template head<D>() = pelorus::per_axis<D>("position", mount);
        variance_.template head<D>() = pelorus::per_axis<D>("noise", deviation).cwiseAbs2();
        if constexpr (Velocity)
            variance_.template tail<D>() =
                pelorus::per_axis<D>("velocity_noise", velocity_deviation.value_or(std::vector<double>{1.0}))
                    .cwiseAbs2();
        else if (velocity_deviation)
            throw pelorus::ParameterError("velocity_noise", "is given, but velocity is not measured (velocity: true)");
    }
    pelorus::Space measurement_space() const { return space(); }
    pelorus::Space cartesian_space() const { return space(); }
    pelorus::Space inverse_space() const { return space(); }

    Measurement measure(const Cartesian& x, const Look&) const { return x - position_; }
    Jacobian jacobian(const Cartesian&, const Look&) const { return Jacobian::Identity(); }
    Noise noise(const Query&, const Look&) const { return variance_.asDiagonal(); }
    Inverse invert(const Measurement& z, const Noise& noise, const Look&) const { return {z + position_, noise}; }

    // Whole batches of what is asked for at every step: differences.
    static const plr_sensor& table() noexcept {
        static const plr_sensor own = [] {
            plr_sensor t = Base::table();
            t.measure = &pelorus::detail::forward<Position, plr_sensor_measure, &Position::measure_batch>;
            t.residual = &pelorus::detail::forward<Position, plr_sensor_residual, &Position::residual_batch>;
            return t;
        }();
        return own;
    }
    plr_status measure_batch(const plr_call& call, const plr_sensor_measure& args) const {
        const plr_const_view here{position_.data(), size, 1, args.out.count, 1, size, 0};
        return subtract(call, args.cartesian, here, args.out, "cartesian");
    }
    plr_status residual_batch(const plr_call& call, const plr_sensor_residual& args) const {
        return subtract(call, args.measurement, args.reference, args.out, "measurement");
    }

private:
    static constexpr int size = Base::measurement_size;

    /// out = from - what, of which there may be one column for all points.
    static plr_status subtract(const plr_call& call, const plr_const_view& from, const plr_const_view& what,
                               const plr_view& out, const char* name) {
        const std::int64_t count = out.count, points = out.cols, step = what.cols == 1 ? 0 : size;
        batches::expect_packed(from, size, points, count, name);
        batches::expect_packed(what, size, what.cols == 1 ? 1 : points, count, "reference");
        batches::expect_packed(out, size, points, count, "out");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const double *const a = batches::at(from, i), *const b = batches::at(what, i);
            for (std::int64_t p = 0; p < points; ++p) {
                double difference[size];
                for (int r = 0; r < size; ++r) difference[r] = a[p * size + r] - b[p * step + r];
                if (!batches::all_finite(difference, size)) throw pelorus::NumericError("a result is not finite");
                std::copy_n(difference, size, batches::at(out, i) + p * size);
            }
        });
    }

    static pelorus::Space space() { return pelorus::kinematic_space(D, std::vector<double>(Velocity ? 2u : 1u, 0.0)); }

    Measurement variance_;
    Cartesian position_;  ///< the mount's; the sensor's own velocity is 0
};

template <int D> using PositionAlone = Position<D, false>;
template <int D> using PositionAndVelocity = Position<D, true>;

/// Chooses by what is measured, then by dimension.
struct Chosen : pelorus::ByDimension<PositionAlone> {
    static plr_instance create(const pelorus::Setup& setup) {
        if (sensing::parameter_value<PositionAlone<3>>(setup, "velocity").integer != 0)
            return pelorus::ByDimension<PositionAndVelocity>::create(setup);
        return pelorus::ByDimension<PositionAlone>::create(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(Chosen, "sensor.position");
