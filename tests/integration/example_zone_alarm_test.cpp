// The stage of sdk/examples/zone_alarm_stage, message by message: what it publishes, what late and repeated messages do, and its
// saved state.
#include <catch2/catch.hpp>
#include <dlfcn.h>

#include <pelorus/messages.hpp>

#include "../fixtures/stage_bench.hpp"

using namespace pelorus::test;

namespace {

constexpr std::int64_t second = 1'000'000'000;
enum : std::uint32_t { occupancy, results };

const plr_plugin& zone_alarm() {
    static void* const library =
        dlopen(PELORUS_PLUGIN_DIR "/examples/zone_alarm_stage/analyzer/zone_alarm.so", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) throw std::runtime_error(dlerror());
    const auto& entry = *static_cast<const plr_entry_point*>(dlsym(library, PLR_ENTRY_SYMBOL));
    return *entry.factory("org.example.analyzer.zone_alarm");
}

/// A square of 2 km about the origin, with a margin of 10 m.
struct Watch {
    Bench bench;
    StageUnderTest stage{bench, zone_alarm(),
                         "{zone: [[-1 km, -1 km], [1 km, -1 km], [1 km, 1 km], [-1 km, 1 km]], margin: 10 m}"};
    pelorus::Space space = pelorus::kinematic_space(3, {1, 1});

    void see(std::int64_t time, double x, std::uint64_t id = 7, std::int32_t status = PLR_TRACK_CONFIRMED,
             std::int64_t told = 0) {
        const std::vector<double> mean = {x, 0, 300, 50, 0, 0};
        const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(6, 6);
        pelorus::TracksBuilder builder("", space);
        builder.add({id, time * second, status, 0, mean.data(), covariance.data(), nullptr, {}, 0, {}, {}});
        const std::int64_t stamp = std::max(time, told) * second;
        stage.receive(0, builder.message(stamp));
    }
    /// What the port `occupancy` has told so far.
    std::vector<double> told() const {
        std::vector<double> numbers;
        for (const Published& published : bench.published)
            if (published.port == occupancy)
                numbers.push_back(published.message->body.values->quantities[0].numbers.data[0]);
        return numbers;
    }
    double scalar(const std::string& name) {
        stage.finish();
        const plr_table& table = bench.published.back().table();
        for (std::uint32_t i = 0; i < table.scalar_count; ++i)
            if (name == table.scalars[i].name) return table.scalars[i].value;
        throw std::runtime_error("no scalar " + name);
    }
};

}  // namespace

TEST_CASE("example of a zone alarm: within the margin nothing changes, beyond it occupancy is told once",
          "[release-only]") {
    Watch watch;
    watch.see(1, -1500);
    watch.see(2, -995);  // in, but not deep enough
    watch.see(3, -985);
    watch.see(4, -1005);  // out, but not far enough
    CHECK(watch.told() == std::vector<double>{1});
    watch.see(5, 0, 8);
    watch.see(6, -1011);
    CHECK(watch.told() == std::vector<double>{1, 2, 1});
    CHECK(watch.scalar("entries") == 2);
    CHECK(watch.scalar("exits") == 1);
    CHECK(watch.scalar("inside_time") == 3);  // the second one has been seen at one time only
}

TEST_CASE("example of a zone alarm: what comes late or twice changes nothing, nor does a track that is tentative",
          "[release-only]") {
    Watch watch;
    watch.see(1, -1500);
    watch.see(5, 0);
    watch.see(5, 0);
    watch.see(3, -1500);
    watch.see(6, 0, 9, PLR_TRACK_TENTATIVE);
    CHECK(watch.told() == std::vector<double>{1});
    watch.see(5, 0, 7, PLR_TRACK_DELETED, 8);  // where it was seen last, told at 8 s
    CHECK(watch.told() == std::vector<double>{1, 0});
    watch.see(5, 0, 7, PLR_TRACK_DELETED, 8);
    watch.see(5, 0);  // the message of 5 s once more: no new track
    CHECK(watch.told() == std::vector<double>{1, 0});
    CHECK(watch.scalar("lost") == 1);
    CHECK(watch.scalar("ignored") == 4);
    watch.see(8, 0, 10);  // begins when the other one ended
    CHECK(watch.told().back() == 1);
}

TEST_CASE("example of a zone alarm: state is saved whole, the same bytes again, and what is broken is refused",
          "[release-only]") {
    Watch watch;
    watch.see(1, -1500);
    watch.see(2, 0);
    watch.see(3, 0, 8);
    const std::vector<unsigned char> saved = watch.stage.save();
    Watch other;
    other.see(1, 0, 20);
    const std::vector<unsigned char> before = other.stage.save();
    for (std::size_t size = 0; size < saved.size(); ++size) {
        const std::vector<unsigned char> part(saved.begin(), saved.begin() + static_cast<std::ptrdiff_t>(size));
        CHECK_THROWS_AS(other.stage.load(part), CallFailed);
        std::vector<unsigned char> changed = saved;
        changed[size] ^= 0x10;
        CHECK_THROWS_AS(other.stage.load(changed), CallFailed);
    }
    CHECK(other.stage.save() == before);
    other.stage.load(saved);
    CHECK(other.stage.save() == saved);
    watch.see(9, 2000);
    other.see(9, 2000);
    CHECK(other.stage.save() == watch.stage.save());
    CHECK(other.scalar("inside_time") == 7);
}
