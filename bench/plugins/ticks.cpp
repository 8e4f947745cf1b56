// source.bench_ticks: scans that cost nothing to make, so that what is measured is their way through the runtime.
#include <cstdint>
#include <vector>

#include <pelorus/pelorus.hpp>

namespace {

struct Ticks : pelorus::Stage<Ticks> {
    static constexpr const char* kind = "source";

    int scans = 0, measurements = 0;
    std::int64_t k = 0;
    pelorus::ScanBuilder scan{"ticks", "", pelorus::position_space(3)};

    static void describe(pelorus::Describe<Ticks>& plugin) {
        plugin.title("Scans of nothing").purpose("Publishes the same scan again and again, for measuring the runtime.");
        plugin.in_port("commands", PLR_MESSAGE_VALUES, "are taken and forgotten", PLR_PORT_OPTIONAL);
        plugin.out_port("scans", PLR_MESSAGE_SCAN, "measurements of the sensor `ticks`, a second apart");
        plugin.parameter("scans", &Ticks::scans).initially("1000").min(1).doc("how many");
        plugin.parameter("measurements", &Ticks::measurements).initially("0").min(0).doc("in each scan");
    }

    void setup(const pelorus::Setup&) {
        const pelorus::Vector<3> point(1.0, 2.0, 3.0);
        const pelorus::Matrix<3> covariance = pelorus::Matrix<3>::Identity();
        for (int i = 0; i < measurements; ++i) scan.add(static_cast<std::uint64_t>(i), point.data(), covariance.data());
    }
    std::vector<pelorus::Stream> out_streams(std::uint32_t) const {
        pelorus::Stream stream;
        stream.sensor = "ticks";
        stream.space = pelorus::position_space(3);
        return {stream};
    }
    plr_next next() const {
        const std::int64_t time = k * 1'000'000'000;
        return {sizeof(plr_next), k < scans ? std::uint32_t{PLR_NEXT_DATA} : std::uint32_t{PLR_NEXT_END}, time, time};
    }
    void emit(const pelorus::Event& event) {
        publish(0, scan.message(event.time));
        ++k;
    }
    void on_values(const pelorus::Event&, const plr_values&) {}
};

}  // namespace

PELORUS_PLUGIN(Ticks, "source.bench_ticks");
