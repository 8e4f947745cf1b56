/// The pulses among which a waveform is chosen: S geometric, B linear for each S, within caps on both variances.
///
/// The determinant of the noise is the same for all pulses, and a longer or more strongly chirped one stretches the ellipse without bound:
/// without caps there would be no best one. S caps the variance of range (over A), 1/S + B^2 S that of range rate.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "outlook.hpp"

namespace waveform {

/// Parameters of the plugins that deal in pulses; Plugin derives from it.
class PulseParameters {
public:
    template <class Plugin> static void describe_base(pelorus::Describe<Plugin>& plugin) {
        plugin.parameter("dimension", &PulseParameters::dimension)
            .initially("2")
            .min(2)
            .max(3)
            .doc("2: the sensor measures range, range rate and azimuth; 3: elevation, too");
        plugin.parameter("base_length", &PulseParameters::base_length)
            .unit("s")
            .initially("10 s")
            .above(0)
            .doc(
                "S of the pulse that the sensor's own noise is stated for: deviation of range over that of range rate");
        plugin.parameter("base_chirp", &PulseParameters::base_chirp)
            .unit("1/s")
            .initially("0 1/s")
            .doc("B of the pulse that the sensor's own noise is stated for");
    }

    int dimension = 2;
    double base_length = 10, base_chirp = 0;

    NormalisedPulse base() const noexcept { return {base_length, base_chirp}; }
    /// T of a pulse. Throws ArgumentError where there is no such pulse.
    Transform change(double length, double chirp) const {
        if (!(length > 0) || !std::isfinite(length)) throw pelorus::ArgumentError("length: is not above 0 s");
        if (!std::isfinite(chirp)) throw pelorus::ArgumentError("chirp: is not finite");
        return pulse_change(base(), {length, chirp});
    }
    pelorus::Space pulse_space() const {
        return pelorus::Space(
            {{"length", "s", base_length, 0.5 * base_length, false}, {"chirp", "1/s", base_chirp, 1, false}});
    }
};

class LibraryParameters : public PulseParameters {
public:
    template <class Plugin>
    static void describe_library(pelorus::Describe<Plugin>& plugin, const char* lengths, const char* chirps) {
        describe_base(plugin);
        plugin.parameter("lengths", &LibraryParameters::lengths)
            .initially(lengths)
            .min(1)
            .max(257)
            .doc("how many values of S are tried, geometric");
        plugin.parameter("chirps", &LibraryParameters::chirps)
            .initially(chirps)
            .min(1)
            .max(257)
            .doc("how many values of B are tried for each S, linear between the two that the cap allows");
        plugin.parameter("minimum_length", &LibraryParameters::minimum_length)
            .unit("s")
            .initially("0.1 s")
            .above(0)
            .doc("least S");
        plugin.parameter("maximum_length", &LibraryParameters::maximum_length)
            .unit("s")
            .initially("10 s")
            .above(0)
            .doc("largest S: caps the variance of range");
        plugin.parameter("maximum_rate_variance", &LibraryParameters::maximum_rate_variance)
            .unit("1/s")
            .initially("10 1/s")
            .above(0)
            .doc("largest 1/S + B^2 S: caps the variance of range rate");
    }

    /// The base pulse first, so that it is kept unless another is better. Throws ParameterError.
    std::vector<NormalisedPulse> pulses() const {
        if (minimum_length > maximum_length) throw pelorus::ParameterError("minimum_length", "is above maximum_length");
        std::vector<NormalisedPulse> out{base()};
        for (int i = 0; i < lengths; ++i) {
            const double share = lengths == 1 ? 1.0 : static_cast<double>(i) / (lengths - 1);
            const double length = minimum_length * std::pow(maximum_length / minimum_length, share);
            const double spare = maximum_rate_variance - 1 / length;
            if (spare < -1e-9 * maximum_rate_variance) continue;  // too short for the cap even without a chirp
            const double largest = std::sqrt(std::max(spare, 0.0) / length);
            const int count = largest > 0 ? chirps : 1;
            for (int k = 0; k < count; ++k) {
                const double place = count == 1 ? 0.0 : static_cast<double>(2 * k - (count - 1)) / (count - 1);
                out.push_back({length, largest * place});
            }
        }
        return out;
    }

    int lengths = 17, chirps = 33;
    double minimum_length = 0.1, maximum_length = 10, maximum_rate_variance = 10;
};

/// The choices of a criterion, for ParameterBuilder.
inline std::vector<std::pair<std::string, std::string>> criteria() {
    return {{"determinant", "det of the covariance afterwards: the volume of what is not known"},
            {"trace", "sum of all its variances, numbers of m, m/s and m/s2 added up"},
            {"position_trace", "sum of the variances of position"},
            {"mutual_information",
             "of state and measurement, the largest; for Gaussian densities the same choice as determinant"}};
}

/// Shapes of what `choose` is given and must answer. Throws ArgumentError.
inline void check_choose(const plr_waveform_choose& args, int measured, int parameters, int horizon) {
    const std::int64_t n = args.waveform.count, m = measured, h = horizon;
    if (args.cartesian == nullptr) throw pelorus::ArgumentError("cartesian: is missing");
    const auto c = static_cast<std::int64_t>(args.cartesian->size);
    if (c > most_states)
        throw pelorus::ArgumentError("cartesian: has " + std::to_string(c) + " components, at most 12 are possible");
    pelorus::expect(args.mean, c, h, n, "mean");
    pelorus::expect(args.covariance, c, c * h, n, "covariance");
    pelorus::expect(args.projected, m, m * h, n, "projected");
    pelorus::expect(args.cross, c, m * h, n, "cross");
    pelorus::expect(args.base_noise, m, m, n, "base_noise");
    pelorus::expect(args.waveform, parameters, 1, n, "waveform");
    pelorus::expect(args.noise, m, m, n, "noise");
    if (args.criterion.data != nullptr) pelorus::expect(args.criterion, 1, 1, n, "criterion");
}

/// Writes what was chosen for item i.
template <std::size_t W>
void answer(const plr_waveform_choose& args, std::int64_t i, const std::array<double, W>& parameters,
            const Noise& noise, double criterion) {
    if (!std::isfinite(criterion)) throw pelorus::NumericError("the criterion is not finite");
    store_noise(args.noise, i, noise);
    for (std::size_t k = 0; k < W; ++k)
        args.waveform.data[i * args.waveform.item_stride + static_cast<std::int64_t>(k) * args.waveform.row_stride] =
            parameters[k];
    if (args.criterion.data != nullptr) args.criterion.data[i * args.criterion.item_stride] = criterion;
}

/// Answers the noise of each item's waveform: transform_of(i) is its T.
template <class TransformOf>
plr_status answer_noise(const plr_call& call, const plr_waveform_noise& args, int measured, int parameters,
                        TransformOf&& transform_of) {
    const std::int64_t n = args.out.count;
    pelorus::expect(args.waveform, parameters, 1, n, "waveform");
    pelorus::expect(args.base_noise, measured, measured, n, "base_noise");
    pelorus::expect(args.out, measured, measured, n, "out");
    return pelorus::for_items(call, n, [&](std::int64_t i) {
        Noise noise = load_noise(args.base_noise, i);
        transform(transform_of(i), noise, noise);
        store_noise(args.out, i, noise);
    });
}

/// Parameter k of item i.
inline double parameter(const plr_const_view& waveform, std::int64_t i, std::int64_t k) noexcept {
    return waveform.data[i * waveform.item_stride + k * waveform.row_stride];
}

}  // namespace waveform
