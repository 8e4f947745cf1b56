// Frames with bytes changed at random: whatever comes in, the source refuses or publishes it, and stays alive.
#include <limits>
#include <random>

#include <catch2/catch.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"
#include "udp_source.hpp"

namespace {

const std::vector<std::string> seeds{
    "{\"pelorus\":1,\"kind\":\"scan\",\"sender\":\"mast\",\"session\":2,\"sequence\":1,\"time_ns\":1000,\"arrival_ns\":"
    "2000,\"sensor\":\"radar\",\"components\":[\"position.x\",\"position.y\",\"position.z\"],\"measurements\":[[1,2,3],"
    "[4.5,-5e3,6]],\"covariance\":[[1,0,0],[0,1,0],[0,0,1]],\"ids\":[1,18446744073709551615],\"snr\":[1,2]}\n",
    "{\"pelorus\":1,\"kind\":\"scan\",\"sender\":\"a\",\"sequence\":0,\"time\":1.5,\"part\":[1,2],\"sensor\":\"radar\","
    "\"measurements\":[[1,2,3]]}\n",
    "{\"pelorus\":1,\"kind\":\"scan\",\"sender\":\"a\",\"sequence\":1,\"time\":1.5,\"part\":[2,2],\"sensor\":\"radar\","
    "\"measurements\":[[1,2,3]]}\n",
    "{\"pelorus\":1,\"kind\":\"truth\",\"sender\":\"a\",\"sequence\":2,\"time\":2,\"ids\":[1],\"states\":[[1,2,3]],"
    "\"extents\":[[[1,0],[0,1]]],\"parents\":[1],\"births_ns\":[0],\"measurements\":[[1,2]]}\n",
    "{\"pelorus\":1,\"kind\":\"tracks\",\"sender\":\"a\",\"sequence\":3}\n{\"pelorus\":1,\"kind\":\"end\",\"sender\":"
    "\"a\",\"sequence\":3}\n",
    "pelorus,kind,sender,session,sequence,part,parts,sensor,time_ns,id,position.x,position.y,position.z,snr\n"
    "1,scan,csv,1,0,1,1,radar,5,1,1.5,2,3,4\n1,scan,csv,1,0,1,1,radar,5,2,1,\"2\",3,4\n",
    "pelorus,kind,sender,sequence\n1,end,csv,1\n",
};

std::string mutated(std::mt19937_64& random) {
    static const std::vector<std::string> pieces{
        "9223372036854775808",  "-1", "1e999", "null", "[[", "]]", "{\"a\":", "NaN", "\xff", "\\ud800", "\n", ",", "\"",
        "18446744073709551615", "[]", "-0"};
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
    std::string bytes = seeds[below(seeds.size())];
    for (std::size_t change = below(5); change > 0; --change) {
        const std::size_t at = below(bytes.size() + 1);
        switch (below(5)) {
            case 0:
                if (at < bytes.size()) bytes[at] = static_cast<char>(random());
                break;
            case 1:
                bytes.insert(at, pieces[below(pieces.size())]);
                break;
            case 2:
                bytes.erase(at, below(20));
                break;
            case 3:
                if (at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9')
                    bytes[at] = static_cast<char>('0' + below(10));
                break;
            default:
                bytes += seeds[below(seeds.size())].substr(0, at);
                break;
        }
    }
    return bytes;
}

}  // namespace

TEST_CASE("source.udp survives twenty thousand mutated frames, and publishes none that the host refuses",
          "[source.udp]") {
    using namespace pelorus::test;
    using source_udp::UdpSource;
    Bench bench;
    const auto sensor = std::make_shared<Instance>(bench, installed("sensor.position"), "{noise: 1 m}");
    StageUnderTest stage(bench, plugin_of<UdpSource>("source.udp"),
                         "{port: 0, senders: 0, bad_frames: skip, late: keep, duplicates: keep, truth: position, "
                         "reorder_datagrams: 2, maximum_senders: 8}",
                         std::vector<Instance::Part>{{"sensors", "radar", sensor, "{}"}});
    auto& source = *static_cast<UdpSource*>(stage.instance().self());
    std::mt19937_64 random(20260101);
    std::int64_t newest = std::numeric_limits<std::int64_t>::min();
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
        source.take(mutated(random), "192.0.2.1:9", i);
        if (i % 16 != 0) continue;
        for (plr_next next = stage.next(); next.what == PLR_NEXT_DATA; next = stage.next()) {
            REQUIRE(next.arrival >= newest);
            newest = next.arrival;
            stage.emit(next.arrival);
        }
    }
    stage.next();  // tells the counters
    stage.load(stage.save());
    CHECK(bench.counters["datagrams"] == count);
    CHECK(bench.counters["bad_frames"] > count / 4);
    CHECK(bench.published.size() > count / 20);
    CHECK(bench.log.size() < 30);  // all is counted, ten are told
}
