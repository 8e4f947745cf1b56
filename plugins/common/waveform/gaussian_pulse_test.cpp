#include "gaussian_pulse.hpp"

#include <complex>

#include <catch2/catch.hpp>
#include <Eigen/Dense>

namespace {

using namespace waveform;
using Eigen::Matrix2d;

const double pi = std::acos(-1.0);

/// s(t), as the pulse is defined.
std::complex<double> signal(const GaussianPulse& pulse, double t) {
    const double square = pulse.length * pulse.length;
    return std::pow(pi * square, -0.25) * std::exp(std::complex<double>(-t * t / (2 * square), pulse.sweep * t * t));
}

/// |integral of s(t + tau/2) s*(t - tau/2) exp(-j nu t) dt|^2 by the trapezoidal rule, which converges faster than any power here.
double by_quadrature(const GaussianPulse& pulse, double tau, double nu) {
    constexpr int steps = 4000;
    const double reach = 10 * pulse.length, h = 2 * reach / steps;
    std::complex<double> sum = 0;
    for (int k = 0; k <= steps; ++k) {
        const double t = -reach + k * h;
        sum += signal(pulse, t + tau / 2) * std::conj(signal(pulse, t - tau / 2)) *
               std::exp(std::complex<double>(0, -nu * t));
    }
    return std::norm(sum * h);
}

}  // namespace

TEST_CASE("gaussian pulse: the ambiguity function is the integral that it stands for", "[waveform]") {
    for (const GaussianPulse pulse : {GaussianPulse{1, 0}, GaussianPulse{2, 0.7}, GaussianPulse{0.5, -3}})
        for (const double tau : {0.0, 0.3, -0.8})
            for (const double nu : {0.0, 1.1, -2.5}) {
                INFO("length " << pulse.length << ", sweep " << pulse.sweep << ", at " << tau << ", " << nu);
                CHECK(ambiguity(pulse, tau, nu) == Approx(by_quadrature(pulse, tau, nu)).epsilon(1e-9).margin(1e-13));
            }
}

TEST_CASE("gaussian pulse: Fisher information is the curvature of the ambiguity function at its peak", "[waveform]") {
    const double snr = 37;
    for (const GaussianPulse pulse : {GaussianPulse{1, 0}, GaussianPulse{2, 0.7}, GaussianPulse{0.5, -3}}) {
        INFO("length " << pulse.length << ", sweep " << pulse.sweep);
        const double h = 1e-3;
        const auto f = [&](double i, double k) { return by_quadrature(pulse, i * h, k * h); };
        Matrix2d curvature;
        curvature(0, 0) = (f(1, 0) - 2 * f(0, 0) + f(-1, 0)) / (h * h);
        curvature(1, 1) = (f(0, 1) - 2 * f(0, 0) + f(0, -1)) / (h * h);
        curvature(0, 1) = curvature(1, 0) = (f(1, 1) - f(1, -1) - f(-1, 1) + f(-1, -1)) / (4 * h * h);
        const Matrix2d expected = -snr / 2 * curvature;
        CHECK((fisher_information(pulse, snr) - expected).norm() < 1e-4 * expected.norm());
    }
}

TEST_CASE("gaussian pulse: the bound is the inverse of the information in range and range rate", "[waveform]") {
    const double carrier = 2 * pi * 10e9, snr = 100;
    for (const GaussianPulse pulse :
         {GaussianPulse{10e-6, 0}, GaussianPulse{100e-6, 3e9}, GaussianPulse{30e-6, -1e10}}) {
        const double c = speed_of_light;
        const Matrix2d scale = Eigen::Vector2d(c / 2, -c / (2 * carrier)).asDiagonal();
        const Matrix2d expected = scale * fisher_information(pulse, snr).inverse() * scale.transpose();
        const Matrix2d bound = cramer_rao_bound(pulse, carrier, snr);
        for (int r = 0; r < 2; ++r)
            for (int k = 0; k < 2; ++k) CHECK(bound(r, k) == Approx(expected(r, k)).epsilon(1e-9));
        // In the two numbers that shape it, and with an area that no pulse changes.
        const Matrix2d shaped = noise_area(carrier, snr) * noise_shape(normalised(pulse, carrier));
        for (int r = 0; r < 2; ++r)
            for (int k = 0; k < 2; ++k) CHECK(bound(r, k) == Approx(shaped(r, k)).epsilon(1e-12));
        CHECK(bound.determinant() == Approx(std::pow(noise_area(carrier, snr), 2)).epsilon(1e-9));
    }
}

TEST_CASE("gaussian pulse: without sweep it tells range to c l/sqrt(2 snr)", "[waveform]") {
    // Kershaw and Evans 1994: the bound of the pulse with constant carrier, whose errors are uncorrelated.
    const double carrier = 2 * pi * 10e9;
    const Matrix2d bound = cramer_rao_bound({20e-6, 0}, carrier, 50);
    CHECK(std::sqrt(bound(0, 0)) == Approx(speed_of_light * 20e-6 / 10));
    CHECK(std::sqrt(bound(1, 1)) == Approx(speed_of_light / (carrier * 20e-6 * 10)));
    CHECK(bound(0, 1) == 0);
    CHECK(cramer_rao_bound({20e-6, 1e9}, carrier, 50)(0, 1) < 0);
}
