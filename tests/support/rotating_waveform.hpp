// A waveform model whose one parameter turns the noise of the first two components: R = L' R0 L, for tests of sensors that hold one.
#pragma once

#include <cmath>

#include <pelorus/batch_model.hpp>
#include <pelorus/matrix.hpp>

namespace test_support {

/// For a sensor of range, range rate and azimuth.
struct RotatingWaveform : pelorus::Waveform<RotatingWaveform> {
    static constexpr int size = 3;
    pelorus::Space measurement{
        {{"range", "m", 0.0, 0.0, false}, {"range_rate", "m/s", 0.0, 0.0, false}, {"azimuth", "rad", 0.0, 0.0, true}}};
    pelorus::Space waveform{{{"rotation", "rad", 0.0, 1.0, false}}};

    static void describe(pelorus::Describe<RotatingWaveform>& plugin) { plugin.title("Rotation, for tests"); }
    static const plr_plugin& plugin() {
        return *pelorus::detail::plugin<RotatingWaveform>("waveform.test_rotating", "waveform.test_rotating");
    }
    static pelorus::Matrix<size> turn(double phi) {
        pelorus::Matrix<size> l = pelorus::Matrix<size>::Identity();
        l(0, 0) = l(1, 1) = std::cos(phi);
        l(1, 0) = std::sin(phi);
        l(0, 1) = -l(1, 0);
        return l;
    }

    void setup(const pelorus::Setup&) {
        info.measurement = measurement.c();
        info.waveform = waveform.c();
        info.horizon = 1;
    }
    plr_status choose(const plr_call& call, const plr_waveform_choose& args) const {
        return pelorus::for_items(call, args.noise.count, [&](std::int64_t i) {
            pelorus::store<1, 1>(args.waveform, i, pelorus::Matrix<1>::Zero());
            pelorus::store<size, size>(args.noise, i, pelorus::load<size, size>(args.base_noise, i));
        });
    }
    plr_status noise(const plr_call& call, const plr_waveform_noise& args) const {
        return pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
            const double phi = args.waveform.data[i * args.waveform.item_stride];
            if (!(std::fabs(phi) < 10.0)) throw pelorus::NumericError("the rotation is not within 10 rad");
            const pelorus::Matrix<size> l = turn(phi), r0 = pelorus::load<size, size>(args.base_noise, i);
            pelorus::store<size, size>(args.out, i, pelorus::Matrix<size>(l.transpose() * r0 * l));
        });
    }
};

}  // namespace test_support
