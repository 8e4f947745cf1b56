#include "outlook.hpp"

#include "waveform_rig.hpp"

namespace {

using namespace waveform;
using Eigen::MatrixXd;

Prediction prediction_of(const Scene& scene) {
    Prediction out;
    out.covariance = scene.covariance;
    out.projected = scene.projected;
    out.cross = scene.cross;
    out.positions = 2;
    return out;
}

MatrixXd shaped(const Transform& t, const MatrixXd& base) {
    Noise in = base, out = base;
    transform(t, in, out);
    return out;
}

double expected(Criterion criterion, const Scene& scene, const MatrixXd& noise) {
    const MatrixXd after = posterior_of(scene, noise);
    if (criterion == Criterion::trace) return after.trace();
    if (criterion == Criterion::position_trace) return after(0, 0) + after(1, 1);
    const MatrixXd s = scene.projected + noise;
    const double log = std::log(noise.determinant() / s.determinant());
    return criterion == Criterion::determinant ? log : log / 2;
}

}  // namespace

TEST_CASE("waveform noise: a change of pulse gives the bound of the other pulse and keeps the determinant",
          "[waveform]") {
    const NormalisedPulse base{10, 0}, other{3, -0.7};
    const MatrixXd r0 = Eigen::Vector3d(1e4, 1e2, 1e-8).asDiagonal();
    const MatrixXd r = shaped(pulse_change(base, other), r0);
    CHECK((r.topLeftCorner(2, 2) - 1000 * noise_shape(other)).norm() < 1e-9);
    CHECK(r(2, 2) == 1e-8);
    CHECK(std::abs(r.determinant() / r0.determinant() - 1) < 1e-12);
    CHECK((shaped(pulse_change(base, base), r0) - r0).norm() < 1e-12);
    const MatrixXd back = shaped(pulse_change(other, base), r);
    CHECK((back - r0).norm() < 1e-9);
}

TEST_CASE("waveform noise: a rotation is L' R0 L on range and range rate", "[waveform]") {
    MatrixXd r0 = MatrixXd::Zero(3, 3);
    r0 << 1e4, 50, 0.01, 50, 1e2, -0.002, 0.01, -0.002, 1e-6;
    for (const double phi : {0.0, 0.4, 1.5707963267948966, -2.0}) {
        MatrixXd l = MatrixXd::Identity(3, 3);
        l.topLeftCorner(2, 2) << std::cos(phi), -std::sin(phi), std::sin(phi), std::cos(phi);
        const MatrixXd r = shaped(rotation(phi), r0);
        CHECK((r - l.transpose() * r0 * l).norm() < 1e-10);
        CHECK(std::abs(r.determinant() / r0.determinant() - 1) < 1e-11);
    }
}

TEST_CASE("waveform outlook: criteria are those of the covariance after the measurement", "[waveform]") {
    const auto criterion =
        GENERATE(Criterion::determinant, Criterion::trace, Criterion::position_trace, Criterion::mutual_information);
    const bool correlated = GENERATE(false, true);
    Scene scene = first_look();
    if (correlated) {  // of an angle with range and range rate: the general way
        scene.base_noise(0, 2) = scene.base_noise(2, 0) = 2e-3;
        scene.base_noise(1, 2) = scene.base_noise(2, 1) = -3e-4;
    }
    const Noise base = scene.base_noise;
    const Prediction prediction = prediction_of(scene);
    const Outlook outlook(prediction, base, criterion);
    for (const Transform& t :
         {rotation(0), rotation(1.1), pulse_change({10, 0}, {0.3, 2}), pulse_change({10, 0}, {10, 0.995})})
        CHECK(outlook(t) == Approx(expected(criterion, scene, shaped(t, scene.base_noise))).epsilon(1e-7));
    CHECK((posterior(prediction, base) - posterior_of(scene, scene.base_noise)).norm() <
          1e-9 * scene.covariance.norm());
}

TEST_CASE("waveform outlook: the determinant criterion is that of the states' covariances", "[waveform]") {
    const Scene scene = first_look();
    const Noise base = scene.base_noise;
    const Prediction prediction = prediction_of(scene);
    const double told = Outlook(prediction, base, Criterion::determinant)(rotation(0.5));
    const MatrixXd after = posterior_of(scene, shaped(rotation(0.5), scene.base_noise));
    CHECK(told == Approx(std::log(after.determinant() / scene.covariance.determinant())).epsilon(1e-6));
}
