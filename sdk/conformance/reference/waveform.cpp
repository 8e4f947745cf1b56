// Always the base waveform, with the noise that the sensor has by itself: for a sensor of position on three axes.
#include <Eigen/Cholesky>
#include <pelorus/batch_model.hpp>
#include <pelorus/matrix.hpp>

#include "reference_parts.hpp"

namespace pelorus::conformance {

namespace {

struct Waveform : pelorus::Waveform<Waveform> {
    static constexpr int size = 3;
    Space measurement = position_space(size);
    Space waveform = Space({{"effort", "", 1, 1, false}});

    static void describe(Describe<Waveform>& plugin) { plugin.title("The base waveform"); }

    void setup(const Setup&) {
        info.measurement = measurement.c();
        info.waveform = waveform.c();
        info.horizon = 1;
    }

    plr_status choose(const plr_call& call, const plr_waveform_choose& args) const {
        const std::int64_t count = args.waveform.count;
        expect(args.projected, size, size, count, "projected");
        expect(args.base_noise, size, size, count, "base_noise");
        expect(args.noise, size, size, count, "noise");
        return for_items(call, count, [&](std::int64_t i) {
            const Matrix<size> base = load<size, size>(args.base_noise, i),
                               s = load<size, size>(args.projected, i) + base;
            store<1, 1>(args.waveform, i, Matrix<1>::Constant(waveform[0].prior_mean));
            store<size, size>(args.noise, i, base);
            // The trace of the measured components' posterior covariance, R - R S^-1 R.
            if (args.criterion.data != nullptr)
                store<1, 1>(args.criterion, i, Matrix<1>::Constant((base - base * s.llt().solve(base)).trace()));
        });
    }

    plr_status noise(const plr_call& call, const plr_waveform_noise& args) const {
        expect(args.waveform, 1, 1, args.out.count, "waveform");
        expect(args.base_noise, size, size, args.out.count, "base_noise");
        expect(args.out, size, size, args.out.count, "out");
        return for_items(call, args.out.count,
                         [&](std::int64_t i) { store<size, size>(args.out, i, load<size, size>(args.base_noise, i)); });
    }
};

}  // namespace

const plr_plugin* reference_waveform() {
    return pelorus::detail::plugin<Waveform>("pelorus.conformance.waveform", "pelorus.conformance.waveform");
}

}  // namespace pelorus::conformance
