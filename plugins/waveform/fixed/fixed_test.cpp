#include "../../common/waveform/waveform_rig.hpp"

using namespace waveform;
using Eigen::MatrixXd;
using Eigen::VectorXd;

TEST_CASE("fixed waveform: it is always the one that is given, and choose and noise agree", "[waveform]") {
    const Scene scene = first_look();
    const WaveformUnderTest rotated("fixed", "{rotation: 60 deg}"), pulse("fixed", "{length: 10 s, chirp: 0.995 1/s}");
    const auto turned = rotated.choose(scene), chirped = pulse.choose(scene);
    CHECK(turned.waveform(0) == Approx(std::acos(0.5)));
    CHECK((turned.noise - rotated.noise(turned.waveform, scene.base_noise)).norm() == 0);
    // cos^2 60 deg = 1/4
    CHECK(turned.noise(0, 0) == Approx(2575));
    CHECK(turned.noise(1, 1) == Approx(7525));
    CHECK(turned.noise(0, 1) == Approx(-9900 * std::sqrt(3) / 4));
    CHECK(chirped.waveform == VectorXd(Eigen::Vector2d(10, 0.995)));
    CHECK((chirped.noise - pulse.noise(chirped.waveform, scene.base_noise)).norm() == 0);
    MatrixXd expected = MatrixXd::Zero(3, 3);
    expected.topLeftCorner(2, 2) << 10, -9.95, -9.95, 0.1 + 0.995 * 9.95;
    expected *= 1000;
    expected(2, 2) = 1e-8;
    CHECK((chirped.noise - expected).norm() < 1e-8);
    CHECK(turned.criterion ==
          Approx(std::log(posterior_of(scene, turned.noise).determinant() / scene.covariance.determinant())));
}

TEST_CASE("fixed waveform: the base waveform implies the base noise, others keep its determinant", "[waveform]") {
    MatrixXd base = MatrixXd::Zero(3, 3);
    base << 1e4, 50, 0, 50, 1e2, 0, 0, 0, 1e-6;
    const WaveformUnderTest pulse("fixed", "{length: 1 s, base_length: 4 s, base_chirp: 0.5 1/s}");
    CHECK((pulse.noise(Eigen::Vector2d(4, 0.5), base) - base).norm() < 1e-11);
    CHECK(std::abs(pulse.noise(Eigen::Vector2d(0.2, -3), base).determinant() / base.determinant() - 1) < 1e-10);
    CHECK(pulse.info().waveform->components[0].prior_mean == 4);
    pulse.noise(Eigen::Vector2d(0, 1), base, PLR_ITEMS_FAILED);
}

TEST_CASE("fixed waveform: what is not one waveform is refused by name", "[waveform]") {
    const auto refused = [](const std::string& with) {
        try {
            const WaveformUnderTest one("fixed", with);
        } catch (const std::exception& problem) {
            return std::string(problem.what());
        }
        return std::string();
    };
    CHECK(refused("{}") == "rotation: give either rotation or length");
    CHECK(refused("{rotation: 1 rad, length: 1 s}") == "rotation: give either rotation or length");
    CHECK(refused("{rotation: 1 rad, chirp: 1 1/s}") == "chirp: belongs to length");
}
