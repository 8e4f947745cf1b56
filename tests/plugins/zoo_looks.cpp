// A stage that asks the waveform in its slot at each scan, so that one can be seen at work.
#include "zoo.hpp"

namespace {

using Matrix = pelorus::Matrix<3>;

struct ZooLooks : pelorus::Stage<ZooLooks> {
    static constexpr const char* kind = "analyzer";
    pelorus::WaveformPart waveform;
    pelorus::Caller caller;
    pelorus::Space position = pelorus::position_space(3);

    static void describe(pelorus::Describe<ZooLooks>& plugin) {
        plugin.title("Waveform of each scan");
        plugin.slot("waveform", "waveform", 1, 1, "what chooses");
        plugin.in_port("scans", PLR_MESSAGE_SCAN, "when to choose");
    }
    void setup(const pelorus::Setup& setup) {
        waveform = setup.part<pelorus::WaveformPart>("waveform");
        caller.setup(setup);
    }
    void on_scan(const pelorus::Event& event, const plr_scan&) {
        const Matrix covariance = Matrix::Identity();
        const pelorus::Vector<3> mean = pelorus::Vector<3>::Zero();
        Matrix base = 100 * Matrix::Identity(), noise;
        double chosen = 0, criterion = 0;
        const double dt = 1;
        auto choose = pelorus::arguments<plr_waveform_choose>();
        choose.mean = pelorus::const_view(mean.data(), 3, 1, 1);
        choose.covariance = choose.projected = choose.cross = pelorus::const_view(covariance.data(), 3, 3, 1);
        choose.base_noise = pelorus::const_view(base.data(), 3, 3, 1);
        choose.waveform = pelorus::view(&chosen, 1, 1, 1);
        choose.noise = pelorus::view(noise.data(), 3, 3, 1);
        choose.criterion = pelorus::view(&criterion, 1, 1, 1);
        choose.dt = pelorus::const_view(&dt, 1, 1, 1);
        choose.cartesian = position.c();
        caller.require(waveform.call(&plr_waveform::choose, caller.begin(event.time, 1), choose), "choose");
        auto implied = pelorus::arguments<plr_waveform_noise>();
        implied.waveform = pelorus::const_view(&chosen, 1, 1, 1);
        implied.base_noise = choose.base_noise;
        implied.out = choose.noise;
        caller.require(waveform.call(&plr_waveform::noise, caller.begin(event.time, 1), implied), "noise");
    }
};

}  // namespace

PELORUS_PLUGIN(ZooLooks, "org.example.analyzer.zoo_looks");
