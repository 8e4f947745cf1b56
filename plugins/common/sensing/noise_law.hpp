/// The measurement noise that sensors have in common: constant, or by signal-to-noise ratio and range, shaped by a waveform.
///
///     R0 = diag(noise^2)                                                       constant; or, with `snr` or `reference_range`,
///     R0 = diag(noise^2) / s,  s = snr (reference_range / r)^4                 r the range of the object
///     R  = the waveform model's noise(waveform in force, R0)                   where the slot `waveform` is filled
///
/// A signal-to-noise ratio that a call brings is that of the very echo: it stands in place of s, range factor included.
/// Sources: M. A. Richards, Fundamentals of Radar Signal Processing, 2nd ed., McGraw-Hill 2014, 2.1 (the radar equation: power
/// falls with r^4) and 7.2 (variances of delay, Doppler and angle fall with the signal-to-noise ratio).
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/parts.hpp>
#include <pelorus/sensor.hpp>

namespace sensing {

using pelorus::Matrix;
using pelorus::Vector;

template <int M> struct NoiseParameters {
    Vector<M> noise;                             ///< deviations, in the units of the measurement
    std::optional<double> snr, reference_range;  ///< power ratio; m

    template <class Plugin>
    static void describe_noise(pelorus::Describe<Plugin>& plugin, const char* units, const char* initially,
                               const char* components) {
        plugin.parameter("noise", &NoiseParameters::noise)
            .unit(units)
            .initially(initially)
            .above(0.0)
            .doc(std::string("deviations of ") + components + "; for scans that carry no covariances");
        plugin.parameter("snr", &NoiseParameters::snr)
            .above(0.0)
            .doc(
                "signal-to-noise ratio as a power ratio (write `-10 dB`): all of R is divided by it, or by that of the "
                "measurement where a scan tells it; absent: R does not depend on it");
        plugin.parameter("reference_range", &NoiseParameters::reference_range)
            .unit("m")
            .above(0.0)
            .doc(
                "range at which `noise` and `snr` hold: R grows with (range / reference_range)^4; absent: R does not "
                "depend on range");
        plugin.slot("waveform", "waveform", 0, 1,
                    "shapes the noise by the waveform in force; it must speak of the same measurement");
    }
};

/// Immutable after creation.
template <int M> class NoiseLaw {
public:
    NoiseLaw() = default;
    /// Throws PartError where the waveform model shapes another measurement.
    NoiseLaw(const pelorus::Setup& setup, const NoiseParameters<M>& given, const pelorus::Space& measurement)
        : variance_(given.noise.cwiseAbs2()),
          nominal_(given.snr.value_or(1.0)),
          reference_range_(given.reference_range),
          has_ratio_(given.snr || given.reference_range),
          waveform_(setup.optional_part<pelorus::WaveformPart>("waveform")) {
        if (!waveform_) return;
        const pelorus::Space shaped(*waveform_.info().measurement);
        if (!shaped.same(measurement))
            throw pelorus::PartError("waveform", waveform_.id() + " shapes the noise of " + shaped.text() +
                                                     ", this sensor measures " + measurement.text());
        space_ = pelorus::Space(*waveform_.info().waveform);
        for (const pelorus::Component& component : space_.components()) base_.push_back(component.prior_mean);
    }

    /// Those of `flags` that hold with these parameters and this slot.
    std::uint32_t held(std::uint32_t flags) const noexcept {
        if (has_ratio_ || waveform_) flags &= ~std::uint32_t{PLR_SENSOR_CONSTANT_NOISE};
        if (!waveform_) flags &= ~std::uint32_t{PLR_SENSOR_WAVEFORM};
        return flags;
    }
    const pelorus::Space& waveform_space() const noexcept { return space_; }
    std::uint64_t scratch_bytes() const noexcept { return waveform_ ? waveform_.info().scratch_bytes : 0; }
    bool depends_on_range() const noexcept { return reference_range_.has_value(); }

    /// R of an object at `range` m. `snr` (a power ratio) and `waveform` (parameters in force) may be nullptr.
    /// Throws NumericError where it vanishes or has no end, PartFailed where the waveform model fails.
    Matrix<M, M> operator()(double range, const double* snr, const double* waveform, const pelorus::Look& look) const {
        Matrix<M, M> r0 = Matrix<M, M>::Zero();
        r0.diagonal() = variance_ / ratio(range, snr);
        return waveform_ ? shaped(r0, waveform == nullptr ? base_.data() : waveform, look) : r0;
    }

private:
    double ratio(double range, const double* snr) const {
        if (!has_ratio_) return 1.0;
        if (snr != nullptr) {
            if (!(*snr > 0.0))
                throw pelorus::NumericError("the signal-to-noise ratio is " + std::to_string(*snr) +
                                            ", expected a power ratio above 0");
            return *snr;
        }
        if (!reference_range_) return nominal_;
        const double relative = range / *reference_range_, square = relative * relative;
        if (!(square * square > 0.0))
            throw pelorus::NumericError(
                "the object is at the sensor's own position, where noise that grows with range vanishes");
        return nominal_ / (square * square);
    }
    Matrix<M, M> shaped(const Matrix<M, M>& r0, const double* parameters, const pelorus::Look& look) const {
        Matrix<M, M> out;
        auto args = pelorus::arguments<plr_waveform_noise>();
        args.waveform = pelorus::const_view(parameters, space_.size(), 1, 1);
        args.base_noise = pelorus::const_view(r0);
        args.out = pelorus::view(out);
        const plr_call call = pelorus::slice(*look.call, look.item);
        const plr_status status = waveform_.call(&plr_waveform::noise, call, args);
        if (status == PLR_ITEMS_FAILED) throw pelorus::PartFailed(call.item_status[0]);
        pelorus::require(status);
        return out;
    }

    Vector<M> variance_;
    double nominal_ = 1.0;
    std::optional<double> reference_range_;
    bool has_ratio_ = false;
    pelorus::WaveformPart waveform_;
    pelorus::Space space_;
    std::vector<double> base_;
};

}  // namespace sensing
