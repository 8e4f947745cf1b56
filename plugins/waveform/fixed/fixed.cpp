// waveform.fixed: always the same waveform, the control that every scheduler is compared with. See README.md.
#include <optional>

#include "../../common/waveform/pulse_library.hpp"

namespace {

class Fixed : public pelorus::Waveform<Fixed>, public waveform::PulseParameters {
public:
    static void describe(pelorus::Describe<Fixed>& plugin) {
        plugin.title("Fixed waveform")
            .purpose(
                "Commands the same waveform at every look: a rotation of the measurement ellipse, or a Gaussian pulse "
                "with linear frequency modulation. The control for everything that chooses.")
            .equation(
                "R = L' R0 L, L = [cos phi, -sin phi; sin phi, cos phi] on (range, range rate); or R_rv = A [S, -B S; "
                "-B S, 1/S + B^2 S] with A^2 = det R0_rv")
            .source(
                "D. J. Kershaw, R. J. Evans, Optimal waveform selection for tracking systems, IEEE Transactions on "
                "Information Theory 40(5), 1536-1550, 1994; Zhang et al., Acta Electronica Sinica 47(3), 2019 "
                "(rotation)");
        plugin.parameter("rotation", &Fixed::rotation_).unit("rad").doc("phi; or give length");
        plugin.parameter("length", &Fixed::length_).unit("s").above(0).doc("S; or give rotation");
        plugin.parameter("chirp", &Fixed::chirp_).unit("1/s").doc("B, with length; 0 if absent");
        describe_base(plugin);
    }

    void setup(const pelorus::Setup&) {
        if (rotation_.has_value() == length_.has_value())
            throw pelorus::ParameterError("rotation", "give either rotation or length");
        if (chirp_ && !length_) throw pelorus::ParameterError("chirp", "belongs to length");
        measurement_ = waveform::measurement_space(dimension);
        space_ = rotation_ ? pelorus::Space({{"rotation", "rad", 0, 1, false}}) : pulse_space();
        info.measurement = measurement_.c();
        info.waveform = space_.c();
        info.horizon = 1;
    }

    plr_status choose(const plr_call& call, const plr_waveform_choose& args) const {
        waveform::check_choose(args, measurement_.size(), space_.size(), 1);
        return pelorus::for_items(call, args.waveform.count, [&](std::int64_t i) {
            const waveform::Noise base = waveform::load_noise(args.base_noise, i);
            waveform::Noise noise = base;
            const waveform::Prediction prediction = waveform::load_prediction(args, i, 0);
            const auto tell = [&](const auto& parameters, const waveform::Transform& t) {
                waveform::transform(t, base, noise);
                const double criterion = waveform::Outlook(prediction, base, waveform::Criterion::determinant)(t);
                waveform::answer(args, i, parameters, noise, criterion);
            };
            if (rotation_)
                tell(std::array<double, 1>{*rotation_}, waveform::rotation(*rotation_));
            else
                tell(std::array<double, 2>{*length_, chirp_.value_or(0)}, change(*length_, chirp_.value_or(0)));
        });
    }

    plr_status noise(const plr_call& call, const plr_waveform_noise& args) const {
        return waveform::answer_noise(call, args, measurement_.size(), space_.size(), [&](std::int64_t i) {
            const double first = waveform::parameter(args.waveform, i, 0);
            return rotation_ ? waveform::rotation(first) : change(first, waveform::parameter(args.waveform, i, 1));
        });
    }

private:
    std::optional<double> rotation_, length_, chirp_;
    pelorus::Space measurement_, space_;
};

}  // namespace

PELORUS_PLUGIN(Fixed, "waveform.fixed");
