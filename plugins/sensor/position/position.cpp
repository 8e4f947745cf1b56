// sensor.position: measures Cartesian coordinates. See README.md.
#include <pelorus/per_axis.hpp>
#include <pelorus/sensor.hpp>

namespace {

struct Parameters {
    int dimension = 3;
    std::vector<double> deviation, mount;  // m
};

template <int D> struct Position : pelorus::Sensor<Position<D>, D, D>, Parameters {
    using Base = pelorus::Sensor<Position<D>, D, D>;
    using typename Base::Cartesian;
    using typename Base::Inverse;
    using typename Base::Jacobian;
    using typename Base::Measurement;
    using typename Base::Noise;
    using typename Base::Query;
    using Look = pelorus::Look;
    static constexpr std::uint32_t flags = PLR_SENSOR_LINEAR | PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_CAN_INVERT;

    static void describe(pelorus::Describe<Position>& plugin) {
        plugin.title("Cartesian position")
            .purpose(
                "Measures the coordinates of an object relative to the sensor's own position, along the axes of the "
                "frame it stands in: a satellite receiver, a radar network's output, a camera's ground plane.")
            .equation("z = p - m + w, w ~ N(0, diag(noise^2)), m the sensor's position")
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
    }

    void setup(const pelorus::Setup&) {
        variance_ = pelorus::per_axis<D>("noise", deviation).cwiseAbs2();
        position_ = pelorus::per_axis<D>("position", mount);
    }
    pelorus::Space measurement_space() const { return pelorus::position_space(D); }
    pelorus::Space cartesian_space() const { return pelorus::position_space(D); }
    pelorus::Space inverse_space() const { return pelorus::position_space(D); }

    Measurement measure(const Cartesian& x, const Look&) const { return x - position_; }
    Jacobian jacobian(const Cartesian&, const Look&) const { return Jacobian::Identity(); }
    Noise noise(const Query&, const Look&) const { return variance_.asDiagonal(); }
    Inverse invert(const Measurement& z, const Noise& noise, const Look&) const { return {z + position_, noise}; }

private:
    pelorus::Vector<D> variance_, position_;
};

}  // namespace

PELORUS_PLUGIN(pelorus::ByDimension<Position>, "sensor.position");
