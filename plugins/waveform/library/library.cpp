// waveform.library: the best pulse of a library, one step ahead. See README.md.
#include "../../common/waveform/pulse_library.hpp"

namespace {

class Library : public pelorus::Waveform<Library>, public waveform::LibraryParameters {
public:
    static void describe(pelorus::Describe<Library>& plugin) {
        plugin.title("Best pulse of a library")
            .purpose(
                "Tries every Gaussian pulse with linear frequency modulation of a grid and takes the one after which "
                "the "
                "state will be known best. Looks one step ahead.")
            .equation(
                "R_rv = A [S, -B S; -B S, 1/S + B^2 S], A^2 = det R0_rv; P+ = P - P H' (H P H' + R)^-1 H P; the pulse "
                "of "
                "the least det P+, trace P+, trace of its positions, or largest mutual information")
            .source(
                "D. J. Kershaw, R. J. Evans, Optimal waveform selection for tracking systems, IEEE Transactions on "
                "Information Theory 40(5), 1536-1550, 1994");
        plugin.parameter("criterion", &Library::criterion_)
            .initially("determinant")
            .choices(waveform::criteria())
            .doc("what makes a pulse the best");
        describe_library(plugin, "17", "33");
    }

    void setup(const pelorus::Setup&) {
        for (const waveform::NormalisedPulse& pulse : pulses())
            candidates_.push_back({pulse, waveform::pulse_change(base(), pulse)});
        measurement_ = waveform::measurement_space(dimension);
        space_ = pulse_space();
        info.measurement = measurement_.c();
        info.waveform = space_.c();
        info.horizon = 1;
    }

    plr_status choose(const plr_call& call, const plr_waveform_choose& args) const {
        waveform::check_choose(args, measurement_.size(), 2, 1);
        return pelorus::for_items(call, args.waveform.count, [&](std::int64_t i) {
            const waveform::Prediction prediction = waveform::load_prediction(args, i, 0);
            const waveform::Noise base = waveform::load_noise(args.base_noise, i);
            const waveform::Outlook outlook(prediction, base, criterion_);
            const Candidate* best = &candidates_.front();
            double least = outlook(best->change);
            for (const Candidate& candidate : candidates_) {
                const double value = outlook(candidate.change);
                if (!(value < least)) continue;
                least = value;
                best = &candidate;
            }
            if (!std::isfinite(least)) throw pelorus::NumericError("no pulse leads to a finite covariance");
            waveform::Noise noise = base;
            waveform::transform(best->change, base, noise);
            waveform::answer(args, i, std::array<double, 2>{best->pulse.length, best->pulse.chirp}, noise, least);
        });
    }

    plr_status noise(const plr_call& call, const plr_waveform_noise& args) const {
        return waveform::answer_noise(call, args, measurement_.size(), 2, [&](std::int64_t i) {
            return change(waveform::parameter(args.waveform, i, 0), waveform::parameter(args.waveform, i, 1));
        });
    }

private:
    struct Candidate {
        waveform::NormalisedPulse pulse;
        waveform::Transform change;
    };
    waveform::Criterion criterion_ = waveform::Criterion::determinant;
    std::vector<Candidate> candidates_;
    pelorus::Space measurement_, space_;
};

}  // namespace

PELORUS_PLUGIN(Library, "waveform.library");
