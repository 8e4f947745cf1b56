/// Pulses of Gaussian envelope and linear frequency modulation, and what they tell of range and range rate.
///
///     s(t) = (pi l^2)^(-1/4) exp(-t^2/(2 l^2) + j b t^2),      l: length [s], b: sweep [rad/s^2]
///
/// Source: D. J. Kershaw, R. J. Evans, Optimal waveform selection for tracking systems, IEEE Transactions on Information
/// Theory 40(5), 1536-1550, 1994: the ambiguity function, Fisher information and Cramer-Rao bound of this pulse. A delay tau
/// [s] and a Doppler shift nu [rad/s] are tau = 2 r/c and nu = -2 w_c v/c of range r and range rate v, w_c the carrier.
/// All functions are pure.
#pragma once

#include <cmath>

#include <pelorus/matrix.hpp>

namespace waveform {

constexpr double speed_of_light = 299792458.0;  // m/s

struct GaussianPulse {
    double length = 0;  ///< l, s
    double sweep = 0;   ///< b, rad/s2: the frequency rises by 2 b a second
};

/// |A(tau, nu)|^2 of A = integral of s(t + tau/2) s*(t - tau/2) exp(-j nu t) dt; 1 at the origin.
///     = exp(-tau^2/(2 l^2) - l^2 (nu - 2 b tau)^2/2)
inline double ambiguity(const GaussianPulse& pulse, double tau, double nu) noexcept {
    const double shifted = nu - 2 * pulse.sweep * tau, square = pulse.length * pulse.length;
    return std::exp(-tau * tau / (2 * square) - square * shifted * shifted / 2);
}

/// Fisher information of (tau, nu) at a signal-to-noise ratio `snr` = 2 E/N_0: -snr/2 times the second derivatives of
/// |A|^2 at the origin.
inline pelorus::Matrix<2> fisher_information(const GaussianPulse& pulse, double snr) noexcept {
    const double square = pulse.length * pulse.length, b = pulse.sweep;
    pelorus::Matrix<2> out;
    out(0, 0) = snr * (1 / (2 * square) + 2 * b * b * square);
    out(1, 0) = out(0, 1) = -snr * b * square;
    out(1, 1) = snr * square / 2;
    return out;
}

/// Cramer-Rao bound of (range [m], range rate [m/s]) at the carrier `carrier` [rad/s]: T J^-1 T', T = diag(c/2, -c/(2 w_c)).
inline pelorus::Matrix<2> cramer_rao_bound(const GaussianPulse& pulse, double carrier, double snr) noexcept {
    const double c = speed_of_light, square = pulse.length * pulse.length, b = pulse.sweep;
    pelorus::Matrix<2> out;
    out(0, 0) = c * c * square / (2 * snr);
    out(1, 0) = out(0, 1) = -c * c * b * square / (carrier * snr);
    out(1, 1) = c * c / (carrier * carrier * snr) * (1 / (2 * square) + 2 * b * b * square);
    return out;
}

/// The same bound in the two numbers that shape it: N = A [[S, -B S], [-B S, 1/S + B^2 S]]. det N = A^2 whatever the pulse.
struct NormalisedPulse {
    double length = 1;  ///< S = w_c l^2, s
    double chirp = 0;   ///< B = 2 b/w_c, 1/s
};
inline NormalisedPulse normalised(const GaussianPulse& pulse, double carrier) noexcept {
    return {carrier * pulse.length * pulse.length, 2 * pulse.sweep / carrier};
}
/// A = c^2/(2 w_c snr), m^2/s: the product of the deviations of range and range rate where B = 0.
inline double noise_area(double carrier, double snr) noexcept {
    return speed_of_light * speed_of_light / (2 * carrier * snr);
}
/// N/A.
inline pelorus::Matrix<2> noise_shape(const NormalisedPulse& pulse) noexcept {
    pelorus::Matrix<2> out;
    out(0, 0) = pulse.length;
    out(1, 0) = out(0, 1) = -pulse.chirp * pulse.length;
    out(1, 1) = 1 / pulse.length + pulse.chirp * pulse.chirp * pulse.length;
    return out;
}

}  // namespace waveform
