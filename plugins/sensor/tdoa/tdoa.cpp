// sensor.tdoa: measures how much later a signal reaches other receivers than the reference receiver. See README.md.
#include "../../common/sensing/variants.hpp"
#include "../../common/variants/variants.hpp"

#include <array>
#include <string>

#include <pelorus/sensor.hpp>

namespace {

using pelorus::Matrix;
using pelorus::Vector;

enum class Quantity { range, time };

struct Parameters {
    Eigen::MatrixXd receivers;       // m, one a row; the first is the reference
    std::vector<double> deviations;  // m, of a range of arrival
    Quantity quantity = Quantity::range;
    double speed = 0.0;  // m/s
};

/// M receivers besides the reference, on D axes.
template <int M, int D> struct Tdoa : pelorus::Sensor<Tdoa<M, D>, M, D>, Parameters {
    using Base = pelorus::Sensor<Tdoa<M, D>, M, D>;
    using typename Base::Cartesian;
    using typename Base::Jacobian;
    using typename Base::Measurement;
    using typename Base::Noise;
    using typename Base::Query;
    using Look = pelorus::Look;
    static constexpr std::uint32_t flags = PLR_SENSOR_CONSTANT_NOISE;

    static void describe(pelorus::Describe<Tdoa>& plugin);

    void setup(const pelorus::Setup&) {
        for (int k = 0; k <= M; ++k) place_[static_cast<std::size_t>(k)] = receivers.row(k).transpose();
        for (std::size_t k = 1; k < place_.size(); ++k)
            for (std::size_t other = 0; other < k; ++other)
                if (place_[k] == place_[other])
                    throw pelorus::ParameterError("receivers", "rows " + std::to_string(other + 1) + " and " +
                                                                   std::to_string(k + 1) + " are the same place");
        unit_ = quantity == Quantity::time ? 1.0 / speed : 1.0;
        const double squared = unit_ * unit_;
        Vector<M + 1> variance = Vector<M + 1>::Constant(deviations[0] * deviations[0] * squared);
        if (deviations.size() != 1) {
            if (deviations.size() != static_cast<std::size_t>(M + 1))
                throw pelorus::ParameterError("noise", "has " + std::to_string(deviations.size()) +
                                                           " values, expected 1 or " + std::to_string(M + 1) +
                                                           " (the receivers)");
            for (int k = 0; k <= M; ++k)
                variance(k) =
                    deviations[static_cast<std::size_t>(k)] * deviations[static_cast<std::size_t>(k)] * squared;
        }
        noise_.setConstant(variance(0));  // the reference receiver's error is in every difference
        noise_.diagonal() += variance.template tail<M>();
    }
    pelorus::Space measurement_space() const {
        const bool is_time = quantity == Quantity::time;
        std::vector<pelorus::Component> components;
        for (int k = 1; k <= M; ++k)
            components.push_back({(is_time ? "time_difference." : "range_difference.") + std::to_string(k),
                                  is_time ? "s" : "m", 0.0, 0.0, false});
        return pelorus::Space(std::move(components));
    }
    pelorus::Space cartesian_space() const { return pelorus::position_space(D); }

    Measurement measure(const Cartesian& p, const Look&) const {
        const double first = (p - place_[0]).stableNorm();
        Measurement z;
        for (int k = 0; k < M; ++k) z(k) = ((p - place_[static_cast<std::size_t>(k + 1)]).stableNorm() - first) * unit_;
        return z;
    }
    Jacobian jacobian(const Cartesian& p, const Look&) const {
        const Vector<D> first = sight(p, 0);
        Jacobian out;
        for (int k = 0; k < M; ++k)
            out.row(k) = (sight(p, static_cast<std::size_t>(k + 1)) - first).transpose() * unit_;
        return out;
    }
    Noise noise(const Query&, const Look&) const { return noise_; }

private:
    /// From a receiver to the object.
    Vector<D> sight(const Cartesian& p, std::size_t receiver) const {
        const Vector<D> away = p - place_[receiver];
        const double range = away.stableNorm();
        if (!(range > 0.0))
            throw pelorus::NumericError("the object is at a receiver, where its range has no derivative");
        return away / range;
    }

    std::array<Vector<D>, static_cast<std::size_t>(M + 1)> place_;
    double unit_ = 1.0;
    Noise noise_;
};

template <int M, int D> void Tdoa<M, D>::describe(pelorus::Describe<Tdoa>& plugin) {
    plugin.title("Time or range difference of arrival")
        .purpose(
            "Receivers at known places hear one emitter: each tells how much later than the reference receiver. The "
            "reference receiver's error is common to all differences. One place of the emitter cannot be told from a "
            "measurement by this model: tracks begin with another sensor or at given states.")
        .equation(
            "d_i = |p - r_i| - |p - r_0|, i = 1 .. m (time: over the speed of propagation); R_ij = s_0^2 + (i = j) "
            "s_i^2")
        .source(
            "Y. T. Chan, K. C. Ho, A simple and efficient estimator for hyperbolic location, IEEE Transactions on "
            "Signal Processing 42(8), 1905-1915, 1994 (the differences and their covariance)");
    plugin.parameter("receivers", &Parameters::receivers)
        .unit("m")
        .rows(2, 7)
        .cols(2, 3)
        .doc("places of the receivers, one a row of 2 or 3 coordinates; the first is the reference");
    plugin.parameter("noise", &Parameters::deviations)
        .unit("m")
        .initially("[10 m]")
        .above(0.0)
        .rows(1, 7)
        .doc(
            "deviation of the range that a single receiver's arrival tells, one value or one a receiver; for scans "
            "that "
            "carry no covariances");
    plugin.parameter("quantity", &Parameters::quantity)
        .initially("range")
        .choices({{"range", "range differences"}, {"time", "time differences: range differences over `speed`"}})
        .doc("what is measured");
    plugin.parameter("speed", &Parameters::speed)
        .unit("m/s")
        .initially("299792458 m/s")
        .above(0.0)
        .doc("speed of propagation, for time differences: of light, unless it is sound");
}

/// Chooses by the number of receivers and of coordinates.
struct Chosen : variants::Variants<Tdoa<2, 3>> {
    static plr_instance create(const pelorus::Setup& setup) {
        const plr_const_view& places = sensing::parameter_value<Tdoa<2, 3>>(setup, "receivers").numbers;
        return places.cols == 2 ? of_size<2>(setup, places.rows) : of_size<3>(setup, places.rows);
    }

private:
    template <int D, int M = 1> static plr_instance of_size(const pelorus::Setup& setup, std::int64_t rows) {
        if (rows == M + 1) return pelorus::instantiate<Tdoa<M, D>>(setup);
        if constexpr (M < 6) return of_size<D, M + 1>(setup, rows);
        throw pelorus::ParameterError("receivers", "are not 2 to 7 places");
    }
};

}  // namespace

PELORUS_PLUGIN(Chosen, "sensor.tdoa");
