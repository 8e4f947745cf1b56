#include "../../../tests/support/reference.hpp"
#include "../../common/waveform/waveform_rig.hpp"

using namespace waveform;
using Eigen::MatrixXd;

namespace {

/// R of range and range rate after the first look, as the reference has it.
MatrixXd reference_noise(const char* trace) {
    const auto told = test_support::reference("waveform_traces.json")[trace]["1"]["R"];
    MatrixXd out(2, 2);
    out << told[0].get<double>(), told[1].get<double>(), told[1].get<double>(), told[2].get<double>();
    return out;
}

}  // namespace

TEST_CASE("ellipse rotation: the published rule gives the noise of the reference at its first look", "[waveform]") {
    const WaveformUnderTest published("ellipse_rotation", "{rule: published}");
    const auto choice = published.choose(first_look());
    const MatrixXd expected = reference_noise("ACA_W22");
    for (int r = 0; r < 2; ++r)
        for (int c = 0; c < 2; ++c) CHECK(choice.noise(r, c) == Approx(expected(r, c)).epsilon(1e-6));
    CHECK(choice.noise(2, 2) == 1e-8);
    CHECK((choice.noise - published.noise(choice.waveform, first_look().base_noise)).norm() == 0);
}

TEST_CASE("ellipse rotation: the exact rule gives the noise of the reference at its first look", "[waveform]") {
    // The reference projects by cubature, this test by the Jacobian: they differ by 1e-6 here.
    const auto choice = WaveformUnderTest("ellipse_rotation", "{}").choose(first_look());
    const MatrixXd expected = reference_noise("ACA_Wx");
    for (int r = 0; r < 2; ++r)
        for (int c = 0; c < 2; ++c) CHECK(choice.noise(r, c) == Approx(expected(r, c)).epsilon(1e-4));
}

TEST_CASE("ellipse rotation: no angle leaves a smaller determinant than that of the exact rule", "[waveform]") {
    const WaveformUnderTest exact("ellipse_rotation", "{}"), any("fixed", "{rotation: 0}");
    for (const bool longer_in_rate : {false, true}) {
        Scene scene = first_look();
        if (longer_in_rate) scene.base_noise.diagonal() << 1, 1e4, 1e-6;
        const auto choice = exact.choose(scene);
        const double least = posterior_of(scene, choice.noise).determinant();
        for (int k = 0; k < 360; ++k) {
            const Eigen::VectorXd angle = Eigen::VectorXd::Constant(1, k * 3.14159265358979 / 360);
            CHECK(posterior_of(scene, any.noise(angle, scene.base_noise)).determinant() >= least * (1 - 1e-9));
        }
        CHECK(std::abs(choice.noise.determinant() / scene.base_noise.determinant() - 1) < 1e-12);
        CHECK(choice.criterion == Approx(std::log(least / scene.covariance.determinant())).epsilon(1e-6));
    }
}

TEST_CASE("ellipse rotation: a prediction without any covariance of position and velocity turns by a right angle",
          "[waveform]") {
    Scene scene = first_look();
    scene.covariance = MatrixXd::Identity(6, 6);
    scene.cross = polar_slope(scene.mean).transpose();
    scene.projected = polar_slope(scene.mean) * scene.cross;
    const auto choice = WaveformUnderTest("ellipse_rotation", "{rule: published}").choose(scene);
    CHECK(choice.waveform(0) == Approx(std::acos(0.0)));
}
