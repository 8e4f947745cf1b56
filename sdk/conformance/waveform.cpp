// The laws of waveform models: what is commanded and what it implies come from one place.
#include <fmt/format.h>

#include "call_matrices.hpp"
#include "machine/bench.hpp"
#include "space_laws.hpp"
#include "waveform_calls.hpp"

namespace pelorus::conformance {

namespace {

using namespace waveform_calls;
constexpr std::int64_t batch = 9;

struct WaveformTrial {
    explicit WaveformTrial(const Bench& bench)
        : instance(bench.make()),
          facts(info(*instance)),
          measurement(*facts.measurement),
          sample(bench.sample()),
          outlook(sample_outlook(*instance, sample, batch)) {}

    std::unique_ptr<Instance> instance;
    const plr_waveform_info& facts;
    Space measurement;
    Sample sample;
    Outlook outlook;
};

/// Where a noise is not what it should be, to `tolerance` of the deviations; "" where it is.
std::string off(const Eigen::MatrixXd& got, const Eigen::MatrixXd& expected, double tolerance, const Space& space) {
    return first_difference(got, expected, tolerance * element_scales(expected), space, space);
}

}  // namespace

PELORUS_CHECK(
    waveform, "waveform-spaces-well-formed", 2,
    "measurement says what the model shapes, waveform the parameters with their units, its prior means the base "
    "waveform; a scheduler and a sensor compare them by name.",
    {}) {
    const auto instance = bench.make();
    const plr_waveform_info& facts = info(*instance);
    for (const std::string& fault : faults_of(facts.measurement, "measurement", Priors::free)) FAIL_CHECK(fault);
    for (const std::string& fault : faults_of(facts.waveform, "waveform", Priors::free)) FAIL_CHECK(fault);
    if (facts.horizon < 1) FAIL_CHECK("info.horizon is " << facts.horizon << ", expected 1 at least");
}

PELORUS_CHECK(
    waveform, "waveform-base-implies-base-noise", 2,
    "noise of the base waveform (the prior means of its space) is the base noise; a sensor that nobody commands "
    "has the noise that its parameters say.",
    {"waveform-spaces-well-formed", "numbers-finite"}) {
    const WaveformTrial trial(bench);
    const Argument base = base_waveforms(*trial.instance, batch);
    const auto implied = answered_matrices(*trial.instance, noise(*trial.instance, base, trial.outlook.base_noise));
    for (std::int64_t i = 0; i < batch; ++i) {
        const std::string fault =
            off(implied[static_cast<std::size_t>(i)], item(trial.outlook.base_noise, i), 1e-9, trial.measurement);
        if (!fault.empty()) FAIL("noise of the base waveform: " << fault);
    }
}

PELORUS_CHECK(
    waveform, "waveform-choice-implies-its-noise", 2,
    "The noise that choose answers is what noise makes of the waveform chosen; what the scheduler counted with is "
    "what the sensor will have.",
    {"waveform-spaces-well-formed", "numbers-finite"}) {
    const WaveformTrial trial(bench);
    const HotCall call = choose(*trial.instance, trial.outlook);
    const Execution done = execute_well(*trial.instance, call);
    const Argument commanded =
        input("waveform", trial.facts.waveform->size, 1, batch, [&](double* out, std::int64_t i) {
            const Eigen::MatrixXd chosen = item_matrix(call, done, chosen_waveform, i);
            std::copy_n(chosen.data(), chosen.size(), out);
        });
    const HotCall again = noise(*trial.instance, commanded, trial.outlook.base_noise);
    const Execution implied = execute(*trial.instance, again);
    for (std::int64_t i = 0; i < batch; ++i) {
        if (done.failed(i)) continue;
        if (implied.status < 0 || implied.failed(i))
            FAIL("noise refuses the waveform that choose has chosen for item " << i << ": " << implied.told());
        const std::string fault =
            off(item_matrix(again, implied, 0, i), item_matrix(call, done, chosen_noise, i), 1e-9, trial.measurement);
        if (!fault.empty()) FAIL("noise of the waveform chosen for item " << i << ": " << fault);
    }
}

PELORUS_CHECK(waveform, "waveform-criterion-is-optional", 2,
              "With criterion.data NULL choose answers the same waveform and the same noise.",
              {"waveform-spaces-well-formed", "numbers-finite"}) {
    const WaveformTrial trial(bench);
    const HotCall with = choose(*trial.instance, trial.outlook),
                  without = choose(*trial.instance, trial.outlook, false);
    const Execution told = execute_well(*trial.instance, with), silent = execute(*trial.instance, without);
    if (silent.status < 0 || !silent.left_by.empty()) FAIL("choose without a criterion answered " << silent.told());
    for (std::int64_t i = 0; i < batch; ++i) {
        if (told.failed(i)) continue;
        for (const std::size_t output : {std::size_t{chosen_waveform}, std::size_t{chosen_noise}})
            if (silent.failed(i) || item_matrix(with, told, output, i) != item_matrix(without, silent, output, i))
                FAIL("choose with and without a criterion answers another " << with.out[output].name << " for item "
                                                                            << i);
    }
}

PELORUS_CHECK(
    waveform, "waveform-noise-grows-with-base", 3,
    "k times the base noise gives k times the noise: a waveform shapes what the signal-to-noise ratio, range and "
    "weather make of a sensor's noise, it does not know them.",
    {"waveform-base-implies-base-noise"}) {
    WaveformTrial trial(bench);
    const Argument waveforms = sample_waveforms(*trial.instance, trial.sample, batch);
    Argument larger = trial.outlook.base_noise;
    for (double& element : larger.values) element *= 16;
    const HotCall one = noise(*trial.instance, waveforms, trial.outlook.base_noise),
                  other = noise(*trial.instance, waveforms, larger);
    const Execution small = execute_well(*trial.instance, one), large = execute_well(*trial.instance, other);
    for (std::int64_t i = 0; i < batch; ++i) {
        if (small.failed(i) && large.failed(i)) continue;
        if (small.failed(i) != large.failed(i)) FAIL("noise takes a waveform with one base noise and not with another");
        const Eigen::MatrixXd expected = 16 * item_matrix(one, small, 0, i);
        const std::string fault = off(item_matrix(other, large, 0, i), expected, 1e-9, trial.measurement);
        if (!fault.empty()) FAIL("noise of 16 times the base noise: " << fault);
    }
}

}  // namespace pelorus::conformance
