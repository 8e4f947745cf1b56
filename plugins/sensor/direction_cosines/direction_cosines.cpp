// sensor.direction_cosines: measures direction cosines along an array's axes and, where it can, range. See README.md.
#include "../../common/sensing/angles.hpp"
#include "../../common/sensing/mounted_sensor.hpp"
#include "../../common/sensing/variants.hpp"
#include "../../common/variants/variants.hpp"
#include "cosine_model.hpp"

namespace {

using pelorus::Matrix;
using pelorus::Vector;

struct Deviations {
    Vector<2> cosine_noise;
    std::optional<double> range_noise;  // m
};

/// M: 3 with range, 2 without.
template <int M> struct DirectionCosines : sensing::MountedSensor<DirectionCosines<M>, M, 3>, Deviations {
    using Base = sensing::MountedSensor<DirectionCosines<M>, M, 3>;
    using typename Base::Cartesian;
    using typename Base::Inverse;
    using typename Base::Jacobian;
    using typename Base::Measurement;
    using typename Base::Noise;
    static constexpr bool with_range = M == 3;
    static constexpr std::uint32_t flags =
        sensing::mounted_flags | (with_range ? std::uint32_t{PLR_SENSOR_CAN_INVERT} : 0u);
    static constexpr int bias_offset = with_range ? 0 : 1;

    static void describe(pelorus::Describe<DirectionCosines>& plugin) {
        plugin.title("Direction cosines u and v, with or without range")
            .purpose(
                "A planar array in the y-z plane of its mount, looking along x: it measures the direction cosines "
                "along its axes, in which its accuracy is the same at every scan angle, and as a radar range, too.")
            .equation(
                "p = R' (position - m); u = p_y / |p|, v = p_z / |p|, range = |p|; with range, inverse = r (sqrt(1 - "
                "u^2 - v^2), u, v), in front of the array; bias and noise are added")
            .source(
                "X. Tian, Y. Bar-Shalom, Coordinate conversion and tracking for very long range radars, IEEE "
                "Transactions on Aerospace and Electronic Systems 45(3), 1073-1088, 2009 (r-u-v measurements)");
        plugin.parameter("noise", &Deviations::cosine_noise)
            .initially("[1e-3, 1e-3]")
            .above(0.0)
            .doc("deviations of u and v; for scans that carry no covariances");
        plugin.parameter("range_noise", &Deviations::range_noise)
            .unit("m")
            .above(0.0)
            .doc("deviation of range; absent: range is not measured");
        Base::describe_law(plugin);
        Base::describe_inputs(plugin, "m, , ", 3, "range (unused where it is not measured), u and v");
    }

    void setup(const pelorus::Setup& setup) {
        if constexpr (with_range) this->deviations(0) = *range_noise;
        this->deviations.template tail<2>() = cosine_noise;
        Base::setup(setup);
    }
    pelorus::Space measurement_space() const {
        std::vector<pelorus::Component> components;
        if (with_range) components.push_back(sensing::range_component());
        for (const char* const name : {"direction_cosine.u", "direction_cosine.v"})
            components.push_back({name, "", 0.0, 0.0, false});
        return pelorus::Space(std::move(components));
    }
    Measurement seen(const Cartesian& local) const {
        if (!(local(0) > 0.0)) throw pelorus::NumericError("the object is not in front of the array");
        return cosines::seen(local).template tail<M>();
    }
    Jacobian slope(const Cartesian& local) const { return cosines::jacobian(local).template bottomRows<M>(); }
    Inverse converted(const Measurement& z, const Noise& errors) const {
        if constexpr (with_range) {
            const cosines::Converted point = cosines::unbiased(z, errors);
            return {point.mean, point.covariance};
        } else {
            return {z, errors};
        }
    }
};

/// Chooses by what is measured.
struct Chosen : variants::Variants<DirectionCosines<3>> {
    static plr_instance create(const pelorus::Setup& setup) {
        if (sensing::parameter_value<DirectionCosines<3>>(setup, "range_noise").present != 0)
            return pelorus::instantiate<DirectionCosines<3>>(setup);
        return pelorus::instantiate<DirectionCosines<2>>(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(Chosen, "sensor.direction_cosines");
