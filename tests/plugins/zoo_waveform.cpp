// The zoo's waveform: always the same one, which leaves the noise as it is, with a misdeed.
#include "zoo.hpp"

namespace {

struct ZooWaveform : pelorus::Waveform<ZooWaveform> {
    using Base = pelorus::Waveform<ZooWaveform>;
    zoo::Fault fault = zoo::Fault::none;
    std::string in;
    pelorus::Space measurement = pelorus::position_space(3);
    pelorus::Space waveform = pelorus::Space({{"pulse_length", "s", 1e-6, 1, false}});

    static void describe(pelorus::Describe<ZooWaveform>& plugin) {
        plugin.title("A waveform of the zoo");
        zoo::describe(plugin);
    }
    void setup(const pelorus::Setup&) {
        info.measurement = measurement.c();
        info.waveform = waveform.c();
        info.horizon = 1;
    }

    plr_status choose(const plr_call& call, const plr_waveform_choose& args) const {
        return pelorus::for_items(call, args.waveform.count, [&](std::int64_t i) {
            args.waveform.data[i * args.waveform.item_stride] = 1e-6;
            pelorus::store<3, 3>(args.noise, i, pelorus::load<3, 3>(args.base_noise, i));
            args.criterion.data[i * args.criterion.item_stride] = 0;
        });
    }
    plr_status noise(const plr_call& call, const plr_waveform_noise& args) const {
        return pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
            pelorus::store<3, 3>(args.out, i, pelorus::load<3, 3>(args.base_noise, i));
        });
    }

    static const ZooWaveform& of(const void* self) { return *static_cast<const ZooWaveform*>(self); }
    static plr_status choose_entry(const void* self, const plr_call* call, const plr_waveform_choose* args) {
        return zoo::act(of(self), "choose", call, args->base_noise, args->noise,
                        [&] { return Base::table().choose(self, call, args); });
    }
    static plr_status noise_entry(const void* self, const plr_call* call, const plr_waveform_noise* args) {
        return zoo::act(of(self), "noise", call, args->base_noise, args->out,
                        [&] { return Base::table().noise(self, call, args); });
    }
    static const plr_waveform& table() {
        static const plr_waveform zoo = [] {
            plr_waveform t = Base::table();
            t.head.destroy = &zoo::destroy<ZooWaveform>;
            t.choose = &choose_entry;
            t.noise = &noise_entry;
            return t;
        }();
        return zoo;
    }
};

}  // namespace

ZOO_PLUGIN(ZooWaveform, "org.example.waveform.zoo");
