#include "../../common/waveform/pulse_library.hpp"
#include "../../common/waveform/waveform_rig.hpp"

using namespace waveform;
using Eigen::MatrixXd;

namespace {

double criterion_of(const std::string& name, const Scene& scene, const MatrixXd& noise) {
    const MatrixXd after = posterior_of(scene, noise);
    if (name == "trace") return after.trace();
    if (name == "position_trace") return after(0, 0) + after(1, 1);
    const double log = std::log(after.determinant() / scene.covariance.determinant());
    return name == "determinant" ? log : log / 2;
}

}  // namespace

TEST_CASE("pulse library: 17 lengths and 33 chirps up to the caps, the base first", "[waveform]") {
    const auto pulses = LibraryParameters{}.pulses();
    REQUIRE(pulses.size() == 1 + 1 + 16 * 33);  // the shortest pulse is at the cap without any chirp
    CHECK(pulses.front().length == 10);
    CHECK(pulses.front().chirp == 0);
    double largest = 0;
    for (const NormalisedPulse& pulse : pulses) {
        CHECK(pulse.length >= 0.1 * (1 - 1e-12));
        CHECK(pulse.length <= 10 * (1 + 1e-12));
        CHECK(noise_shape(pulse)(1, 1) <= 10 * (1 + 1e-12));
        if (pulse.length > 9.9) largest = std::max(largest, pulse.chirp);
    }
    CHECK(largest == Approx(0.99498743710662));  // sqrt((10 - 1/10)/10)
}

TEST_CASE("waveform library: the pulse chosen is the best of all by its criterion", "[waveform]") {
    const std::string name = GENERATE("determinant", "trace", "position_trace", "mutual_information");
    const WaveformUnderTest library("library", "{criterion: " + name + "}");
    const Scene scene = first_look();
    const auto choice = library.choose(scene);
    double least = std::numeric_limits<double>::infinity();
    for (const NormalisedPulse& pulse : LibraryParameters{}.pulses()) {
        const MatrixXd noise = library.noise(Eigen::Vector2d(pulse.length, pulse.chirp), scene.base_noise);
        least = std::min(least, criterion_of(name, scene, noise));
    }
    CHECK(criterion_of(name, scene, choice.noise) == Approx(least).epsilon(1e-9));
    CHECK(choice.criterion == Approx(least).epsilon(1e-6));
    CHECK(choice.criterion < criterion_of(name, scene, scene.base_noise));
    CHECK((choice.noise - library.noise(choice.waveform, scene.base_noise)).norm() == 0);
}

TEST_CASE("waveform library: by information it chooses what it does by determinant", "[waveform]") {
    const auto determinant = WaveformUnderTest("library", "{criterion: determinant}").choose(first_look());
    const auto information = WaveformUnderTest("library", "{criterion: mutual_information}").choose(first_look());
    CHECK(information.waveform == determinant.waveform);
    CHECK(information.criterion == Approx(determinant.criterion / 2));
}

TEST_CASE("waveform library: caps that contradict each other are refused, or leave the base", "[waveform]") {
    CHECK_THROWS_WITH(WaveformUnderTest("library", "{minimum_length: 2 s, maximum_length: 1 s}"),
                      "minimum_length: is above maximum_length");
    const WaveformUnderTest none("library", "{maximum_rate_variance: 0.01 1/s}");
    const auto choice = none.choose(first_look());
    CHECK(choice.waveform == Eigen::VectorXd(Eigen::Vector2d(10, 0)));
    CHECK((choice.noise - first_look().base_noise).norm() < 1e-12);
}
