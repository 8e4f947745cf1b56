#include "../../common/waveform/pulse_library.hpp"
#include "../../common/waveform/waveform_rig.hpp"

using namespace waveform;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Acceleration with discrete noise of that deviation (m/s2).
WaveformUnderTest lookahead(const std::string& with, const std::string& deviation = "7.4659806 m/s2") {
    static test_support::Bench parts;
    const auto motion = test_support::part(parts, "motion", "constant_acceleration",
                                           "{dimension: 2, form: discrete, acceleration: " + deviation + "}");
    return WaveformUnderTest("lookahead", with, {{"motion", "", motion}});
}

MatrixXd slope_at(const Scene& scene, int look) { return polar_slope(scene.mean.col(look)); }

/// The least criterion after both looks over all pairs of pulses, and the pulse that begins the best.
VectorXd best_of_all_pairs(const std::string& criterion, const Scene& scene, const std::vector<NormalisedPulse>& pulses,
                           double& least) {
    const WaveformUnderTest any("fixed", "{length: 1 s}");
    least = 1e300;
    VectorXd best;
    for (const NormalisedPulse& first : pulses) {
        const MatrixXd after =
            posterior_of(scene, any.noise(Eigen::Vector2d(first.length, first.chirp), scene.base_noise));
        const MatrixXd p =
            acceleration_step(1) * after * acceleration_step(1).transpose() + acceleration_noise(1, 55.740866328);
        const MatrixXd h = slope_at(scene, 1);
        for (const NormalisedPulse& second : pulses) {
            const MatrixXd r = any.noise(Eigen::Vector2d(second.length, second.chirp), scene.base_noise);
            const MatrixXd end = p - p * h.transpose() * (h * p * h.transpose() + r).inverse() * h * p;
            const double value = criterion == "determinant"
                                     ? std::log(end.determinant() / scene.covariance.rightCols(6).determinant())
                                     : end(0, 0) + end(1, 1);
            if (!(value < least - 1e-9 * std::abs(least))) continue;
            least = value;
            best = Eigen::Vector2d(first.length, first.chirp);
        }
    }
    return best;
}

}  // namespace

TEST_CASE("lookahead: one look ahead it chooses what the library does", "[waveform]") {
    const std::string name = GENERATE("determinant", "trace", "position_trace", "mutual_information");
    const auto choice =
        lookahead("{horizon: 1, lengths: 17, chirps: 33, criterion: " + name + "}").choose(first_look());
    const auto expected = WaveformUnderTest("library", "{criterion: " + name + "}").choose(first_look());
    CHECK(choice.waveform == expected.waveform);
    CHECK(choice.noise == expected.noise);
    CHECK(choice.criterion == expected.criterion);
}

TEST_CASE("lookahead: with a beam as wide as the library it finds the best of all sequences", "[waveform]") {
    const std::string criterion = GENERATE("determinant", "position_trace");
    const Scene scene = first_look(2);
    LibraryParameters library;
    library.lengths = 3;
    library.chirps = 5;
    const std::string small = "lengths: 3, chirps: 5, criterion: ";
    double least = 0;
    const VectorXd best = best_of_all_pairs(criterion, scene, library.pulses(), least);
    const auto wide = lookahead("{horizon: 2, beam: 64, " + small + criterion + "}").choose(scene);
    CHECK(wide.waveform == best);
    CHECK(wide.criterion == Approx(least).epsilon(1e-6));
    const auto narrow = lookahead("{horizon: 2, beam: 1, " + small + criterion + "}").choose(scene);
    CHECK(narrow.criterion >= wide.criterion - 1e-9 * std::abs(wide.criterion));
    const auto myopic = WaveformUnderTest("library", "{" + small + criterion + "}");
    CHECK(narrow.waveform == myopic.choose(first_look()).waveform);
}

TEST_CASE("lookahead: noise that comes between the looks counts", "[waveform]") {
    const Scene scene = first_look(2);
    const auto calm = lookahead("{criterion: position_trace}", "0.01 m/s2").choose(scene);
    const auto rough = lookahead("{criterion: position_trace}", "100 m/s2").choose(scene);
    CHECK(calm.criterion < rough.criterion);
}

TEST_CASE("lookahead: a motion that does not fit the predictions is refused by name", "[waveform]") {
    test_support::Bench bench;
    const auto line = test_support::part(bench, "motion", "constant_acceleration", "{dimension: 1}");
    const WaveformUnderTest other("lookahead", "{}", {{"motion", "", line}});
    CHECK(other.info().horizon == 2);
    CHECK_THROWS_WITH(
        WaveformUnderTest("lookahead", "{minimum_length: 2 s, maximum_length: 1 s}", {{"motion", "", line}}),
        "minimum_length: is above maximum_length");
}
