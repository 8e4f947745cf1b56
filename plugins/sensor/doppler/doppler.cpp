// sensor.doppler: measures how fast the way of a signal over the object grows, or the frequency shift of that. See README.md.
#include "../../common/sensing/polar_model.hpp"
#include "../../common/sensing/variants.hpp"
#include "../../common/variants/variants.hpp"

#include <optional>
#include <string>

#include <pelorus/sensor.hpp>

namespace {

using pelorus::Vector;

using Numbers = std::vector<double>;

struct Parameters {
    Numbers receiver;                                          // m
    std::optional<Numbers> receiver_velocity;                  // m/s
    std::optional<Numbers> transmitter, transmitter_velocity;  // m, m/s
    std::optional<double> carrier, frequency_noise;            // Hz
    double deviation = 0.0, speed = 0.0;                       // m/s
};

template <int D> struct Doppler : pelorus::Sensor<Doppler<D>, 1, 2 * D>, Parameters {
    using Base = pelorus::Sensor<Doppler<D>, 1, 2 * D>;
    using typename Base::Cartesian;
    using typename Base::Jacobian;
    using typename Base::Measurement;
    using typename Base::Noise;
    using typename Base::Query;
    using Look = pelorus::Look;
    static constexpr std::uint32_t flags = PLR_SENSOR_CONSTANT_NOISE;

    static void describe(pelorus::Describe<Doppler>& plugin);

    void setup(const pelorus::Setup&) {
        ends_[0].position = axes("receiver", receiver);
        if (receiver_velocity) ends_[0].velocity = axes("receiver_velocity", *receiver_velocity);
        if (transmitter) {
            end_count_ = 2;
            ends_[1].position = axes("transmitter", *transmitter);
            if (transmitter_velocity) ends_[1].velocity = axes("transmitter_velocity", *transmitter_velocity);
        } else if (transmitter_velocity) {
            throw pelorus::ParameterError("transmitter_velocity",
                                          "is given without `transmitter`: a monostatic sensor has the receiver's");
        }
        double noise = deviation;
        if (carrier) {
            if (!frequency_noise)
                throw pelorus::ParameterError("frequency_noise", "is missing: with `carrier` a frequency is measured");
            factor_ =
                -*carrier / speed * (transmitter ? 1.0 : 2.0);  // the monostatic way grows twice as fast as the range
            noise = *frequency_noise;
        } else if (frequency_noise) {
            throw pelorus::ParameterError("frequency_noise", "is given without `carrier`: a range rate is measured");
        }
        variance_ = noise * noise;
    }
    pelorus::Space measurement_space() const {
        if (carrier) return pelorus::Space({{"frequency_shift", "Hz", 0.0, 0.0, false}});
        return pelorus::Space({{transmitter ? "path_rate" : "range_rate", "m/s", 0.0, 0.0, false}});
    }
    pelorus::Space cartesian_space() const { return pelorus::kinematic_space(D, {0.0, 0.0}); }

    Measurement measure(const Cartesian& x, const Look&) const {
        double sum = 0.0;
        for (int k = 0; k < end_count_; ++k)
            sum += sensing::range_rate<D>(x.template head<D>() - ends_[k].position,
                                          x.template tail<D>() - ends_[k].velocity);
        return Measurement(sum * factor_);
    }
    Jacobian jacobian(const Cartesian& x, const Look&) const {
        Jacobian sum = Jacobian::Zero();
        for (int k = 0; k < end_count_; ++k)
            sum += sensing::range_rate_slope<D>(x.template head<D>() - ends_[k].position,
                                                x.template tail<D>() - ends_[k].velocity);
        return sum * factor_;
    }
    Noise noise(const Query&, const Look&) const { return Noise(variance_); }

private:
    struct End {
        Vector<D> position = Vector<D>::Zero(), velocity = Vector<D>::Zero();
    };

    static Vector<D> axes(const char* parameter, const Numbers& values) {
        if (values.size() == static_cast<std::size_t>(D)) return Eigen::Map<const Vector<D>>(values.data());
        throw pelorus::ParameterError(parameter, "has " + std::to_string(values.size()) + " values, expected " +
                                                     std::to_string(D) + ", as many as `receiver`");
    }

    End ends_[2];
    int end_count_ = 1;
    double factor_ = 1.0, variance_ = 0.0;
};

template <int D> void Doppler<D>::describe(pelorus::Describe<Doppler>& plugin) {
    plugin.title("Range rate or frequency shift, monostatic or bistatic")
        .purpose(
            "A continuous-wave radar, a passive radar with a broadcast transmitter, a sonar: how fast the way of the "
            "signal over the object grows. A single measurement tells no position.")
        .equation(
            "rate(a) = (p - a)'(v - a') / |p - a| for a place a with velocity a'; monostatic: range_rate = "
            "rate(receiver), bistatic: path_rate = rate(receiver) + rate(transmitter); frequency_shift = -(carrier / "
            "speed) (2 range_rate or path_rate)")
        .source("N. J. Willis, Bistatic Radar, 2nd ed., Artech House 1995, chapter 6 (Doppler relationships)");
    plugin.parameter("receiver", &Parameters::receiver)
        .unit("m")
        .initially("[0 m, 0 m, 0 m]")
        .rows(2, 3)
        .doc("where the receiver stands; as many coordinates as the sensor has axes");
    plugin.parameter("receiver_velocity", &Parameters::receiver_velocity)
        .unit("m/s")
        .rows(2, 3)
        .doc("its velocity, which does not move `receiver`; absent: it stands still");
    plugin.parameter("transmitter", &Parameters::transmitter)
        .unit("m")
        .rows(2, 3)
        .doc("where the transmitter stands; absent: at the receiver (monostatic)");
    plugin.parameter("transmitter_velocity", &Parameters::transmitter_velocity)
        .unit("m/s")
        .rows(2, 3)
        .doc("its velocity; absent: it stands still");
    plugin.parameter("noise", &Parameters::deviation)
        .unit("m/s")
        .initially("1 m/s")
        .above(0.0)
        .doc("deviation of a range rate or path rate; for scans that carry no covariances");
    plugin.parameter("carrier", &Parameters::carrier)
        .unit("Hz")
        .above(0.0)
        .doc("frequency of the transmitted signal: its shift is measured; absent: the rate itself is");
    plugin.parameter("frequency_noise", &Parameters::frequency_noise)
        .unit("Hz")
        .above(0.0)
        .doc("deviation of a frequency shift, with `carrier`");
    plugin.parameter("speed", &Parameters::speed)
        .unit("m/s")
        .initially("299792458 m/s")
        .above(0.0)
        .doc("speed of propagation, with `carrier`: of light, unless it is sound");
}

/// Chooses by the number of the receiver's coordinates.
struct Chosen : variants::Variants<Doppler<3>> {
    static plr_instance create(const pelorus::Setup& setup) {
        if (sensing::parameter_value<Doppler<3>>(setup, "receiver").numbers.rows == 2)
            return pelorus::instantiate<Doppler<2>>(setup);
        return pelorus::instantiate<Doppler<3>>(setup);
    }
};

}  // namespace

PELORUS_PLUGIN(Chosen, "sensor.doppler");
