// A share of the effort that goes into range: the better range, the worse range rate; with what a waveform model may do wrong.
#include <cmath>

#include <Eigen/Cholesky>
#include <pelorus/pelorus.hpp>

#include "defect.h"

namespace {

using Noise = pelorus::Matrix<2>;

struct Saboteur : pelorus::Waveform<Saboteur> {
    pelorus::Space measurement = pelorus::Space(
        {{"range", "m", 0, 0, false}, {"range_rate", "m/s", 0, 0, DEFECT("waveform-spaces-well-formed") != 0}});
    // A deviation of 0 is as lawful as any: the model says nothing of how far one may go.
    pelorus::Space waveform =
        pelorus::Space({{"effort", "", 1, NEAR_MISS("waveform-spaces-well-formed") ? 0 : 0.5, false}});

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A waveform with a defect")
            .purpose("Shares effort between range and range rate, for the proof that the conformance suites can fail.")
            .equation("R = D R0 D, D = diag(1/s, s); s of 1/2, 1, 2 that leaves the least trace of R - R S^-1 R")
            .source("the saboteurs' own");
    }
    void setup(const pelorus::Setup&) {
        info.measurement = measurement.c();
        info.waveform = waveform.c();
        info.horizon = 1;
    }

    plr_status choose(const plr_call& call, const plr_waveform_choose& args) const {
        const std::int64_t count = args.waveform.count;
        const auto c = static_cast<std::int64_t>(args.cartesian->size);
        pelorus::expect(args.mean, c, 1, count, "mean");
        pelorus::expect(args.covariance, c, c, count, "covariance");
        pelorus::expect(args.cross, c, 2, count, "cross");
        pelorus::expect(args.dt, 1, 1, count, "dt");
        if (args.criterion.data != nullptr) pelorus::expect(args.criterion, 1, 1, count, "criterion");
        pelorus::expect(args.projected, 2, 2, count, "projected");
        pelorus::expect(args.base_noise, 2, 2, count, "base_noise");
        pelorus::expect(args.waveform, 1, 1, count, "waveform");
        pelorus::expect(args.noise, 2, 2, count, "noise");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Noise base = pelorus::load<2, 2>(args.base_noise, i),
                        projected = pelorus::load<2, 2>(args.projected, i);
            double best = INFINITY, effort = 1;
            for (const double each : {0.5, 1.0, 2.0}) {
                const Noise r = implied(base, each), s = projected + r;
                const double trace = (r - r * s.llt().solve(r)).trace();
                if (!(trace < best)) continue;
                best = trace;
                effort = each;
            }
            if (!std::isfinite(best)) throw pelorus::NumericError("no effort leads to a finite covariance");
            if (DEFECT("waveform-criterion-is-optional") && args.criterion.data == nullptr)
                effort = effort == 1 ? 2 : 1;
            Noise noise = implied(base, effort);
            if (DEFECT("waveform-choice-implies-its-noise")) noise *= 1.001;
            if (NEAR_MISS("waveform-choice-implies-its-noise")) noise *= 1 + 1e-12;
            pelorus::store<1, 1>(args.waveform, i, pelorus::Matrix<1>::Constant(effort));
            pelorus::store<2, 2>(args.noise, i, noise);
            if (args.criterion.data != nullptr)
                pelorus::store<1, 1>(
                    args.criterion, i,
                    pelorus::Matrix<1>::Constant(NEAR_MISS("waveform-criterion-is-optional") ? 0 : best));
        });
    }

    plr_status noise(const plr_call& call, const plr_waveform_noise& args) const {
        pelorus::expect(args.waveform, 1, 1, args.out.count, "waveform");
        pelorus::expect(args.base_noise, 2, 2, args.out.count, "base_noise");
        pelorus::expect(args.out, 2, 2, args.out.count, "out");
        return pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
            const double effort = pelorus::load<1, 1>(args.waveform, i)(0);
            if (!std::isfinite(effort)) throw pelorus::NumericError("effort is not finite");
            if (!(effort > 0)) throw pelorus::NumericError("effort is not above 0");
            Noise noise = implied(pelorus::load<2, 2>(args.base_noise, i), effort);
            // Lawful noise of the base waveform, whatever it is; of others it grows with the root.
            if (DEFECT("waveform-noise-grows-with-base") && effort != 1 && effort != 2 && effort != 0.5)
                noise /= std::sqrt(noise.trace());
            if (NEAR_MISS("waveform-noise-grows-with-base")) noise *= effort;
            if (NEAR_MISS("waveform-noise-grows-with-base")) noise /= effort;
            pelorus::store<2, 2>(args.out, i, noise);
        });
    }

private:
    static Noise implied(const Noise& base, double effort) {
        const pelorus::Vector<2> d(1 / effort, effort);
        Noise out = d.asDiagonal() * base * d.asDiagonal();
        out(0, 1) = out(1, 0);
        if (DEFECT("waveform-base-implies-base-noise") && effort == 1) out *= 1.01;
        if (NEAR_MISS("waveform-base-implies-base-noise")) out *= 1 + 1e-12;
        return out;
    }
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.waveform.saboteur");
