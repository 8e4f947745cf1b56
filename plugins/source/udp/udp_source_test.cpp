#include "udp_source.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <limits>

#include <catch2/catch.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"

namespace {

using namespace pelorus::test;
using source_udp::UdpSource;

/// source.udp with a radar that measures positions on one axis.
struct Received {
    Bench bench;
    std::unique_ptr<StageUnderTest> stage;

    explicit Received(const std::string& with) {
        const auto sensor =
            std::make_shared<Instance>(bench, installed("sensor.position"), "{noise: 1 m, dimension: 1}");
        stage = std::make_unique<StageUnderTest>(bench, plugin_of<UdpSource>("source.udp"), "{port: 0, " + with + "}",
                                                 std::vector<Instance::Part>{{"sensors", "radar", sensor, "{}"}});
    }
    void take(const std::string& bytes, std::int64_t now = 0) {
        static_cast<UdpSource*>(stage->instance().self())->take(bytes, "192.0.2.1:9", now);
    }
    /// Emits what is there and answers what next() says then.
    plr_next emit_all() {
        plr_next next = stage->next();
        if (next.what == PLR_NEXT_WAIT) next = stage->next();  // a live source waits once at least
        for (; next.what == PLR_NEXT_DATA; next = stage->next()) stage->emit(next.arrival);
        return next;
    }
    bool logged(const std::string& part) const {
        for (const std::string& line : bench.log)
            if (line.find(part) != std::string::npos) return true;
        return false;
    }
    int port() const {
        for (const std::string& line : bench.log)
            if (const auto at = line.find("UDP port "); at != std::string::npos) return std::stoi(line.substr(at + 9));
        return 0;
    }
};

std::string scan(std::uint64_t sequence, const std::string& more = "") {
    const std::string number = std::to_string(sequence);
    return "{\"pelorus\":1,\"kind\":\"scan\",\"sender\":\"mast\",\"sequence\":" + number + ",\"time\":" + number +
           ",\"sensor\":\"radar\",\"measurements\":[[" + number + "],[7]]" + more + "}";
}
const std::string end_of_two = "{\"pelorus\":1,\"kind\":\"end\",\"sender\":\"mast\",\"sequence\":2}";

/// Sends from a socket of its own; over a loopback, a datagram is there when send returns.
void send(int port, const std::string& bytes) {
    const int descriptor = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    CHECK(::sendto(descriptor, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to) ==
          static_cast<ssize_t>(bytes.size()));
    ::close(descriptor);
}

}  // namespace

TEST_CASE("source.udp publishes what comes in through its socket, and ends when the sender has", "[source.udp]") {
    Received r("truth: position, truth_axes: 2");
    CHECK(r.stage->next().what == PLR_NEXT_WAIT);
    CHECK(r.stage->next().what == PLR_NEXT_WAIT);
    REQUIRE(r.port() != 0);
    send(r.port(), scan(0, ",\"ids\":[5,6],\"arrival\":0.5,\"covariance\":[[4]],\"snr\":[3,4],\"times\":[0,0.25]"));
    send(r.port(),
         "{\"pelorus\":1,\"kind\":\"truth\",\"sender\":\"mast\",\"sequence\":1,\"time\":1,\"ids\":[9],"
         "\"states\":[[3,4]],\"measurements\":[[5]]}");
    const plr_next next = r.stage->next();
    CHECK(next.what == PLR_NEXT_DATA);
    CHECK(next.time == 0);
    CHECK(next.arrival == 500'000'000);
    send(r.port(), end_of_two);
    CHECK(r.emit_all().what == PLR_NEXT_END);
    r.stage->finish();
    REQUIRE(r.bench.published.size() == 2);
    const plr_scan& scan = r.bench.published[0].scan();
    CHECK(std::string(scan.sensor) == "radar");
    REQUIRE(scan.measurements.count == 2);
    CHECK(scan.measurements.data[1] == 7);
    CHECK(scan.ids[1] == 6);
    CHECK(scan.covariances.data[0] == 4);
    CHECK(scan.snr.data[1] == 4);
    CHECK(scan.times[1] == 250'000'000);
    const plr_truth& truth = r.bench.published[1].truth();
    CHECK(truth.ids[0] == 9);
    CHECK(truth.state.data[1] == 4);
    CHECK(truth.measurements[0] == 5);
    CHECK(r.bench.counters["datagrams"] == 3);
    CHECK(r.bench.counters["rows"] == 3);
    CHECK(r.bench.log.back() ==
          "3 datagrams, 3 frames, 3 rows, 0 bad, 0 lost, 0 late, 0 duplicate, 0 incomplete, 0 refused");
}

TEST_CASE("source.udp counts measurements that have no ids, so that all differ", "[source.udp]") {
    Received r("idle: 3600 s");
    r.take(scan(0)), r.take(scan(1));
    CHECK(r.emit_all().what == PLR_NEXT_WAIT);
    REQUIRE(r.bench.published.size() == 2);
    CHECK(r.bench.published[0].scan().ids[0] == 1);
    CHECK(r.bench.published[1].scan().ids[1] == 4);
}

TEST_CASE("source.udp ends after so long without a datagram, with what waited for a lost one", "[source.udp]") {
    Received r("idle: 1 us, reorder: 3600 s");
    r.stage->next();
    r.take(scan(0)), r.take(scan(2));
    plr_next next{};
    do {
        next = r.stage->next();
        if (next.what == PLR_NEXT_DATA) r.stage->emit(next.arrival);
    } while (next.what != PLR_NEXT_END);
    CHECK(r.bench.published.size() == 2);
    CHECK(r.bench.counters["lost"] == 1);
    CHECK(r.logged("sender mast: datagram 1 is lost"));
}

TEST_CASE("source.udp ends or goes on at a broken frame, as told, and names it", "[source.udp]") {
    Received strict("idle: 3600 s");
    CHECK_THROWS_WITH(strict.take(scan(0, ",\"ids\":[1]")),
                      "192.0.2.1:9, datagram 1 (sender mast): line 1: ids has 1 entries, expected 2 (bad_frames: skip "
                      "would go on)");
    Received lenient("idle: 3600 s, bad_frames: skip, reorder: 3600 s");
    lenient.take("no frame");
    lenient.take(scan(0)), lenient.take(scan(1, ",\"ids\":[1]")), lenient.take(scan(2));
    CHECK(lenient.logged("192.0.2.1:9, datagram 1 (sender 192.0.2.1:9): line 1: begins with neither { nor the column"));
    lenient.emit_all();
    CHECK(lenient.bench.published.size() == 2);  // the broken one has come in: nobody waits for its number
    CHECK(lenient.bench.counters["bad_frames"] == 2);
    CHECK(lenient.bench.counters["lost"] == 0);
    for (int i = 0; i < 30; ++i) lenient.take("still none");
    CHECK(lenient.bench.log.back() == "further ones are only counted");
    lenient.stage->next();
    CHECK(lenient.bench.counters["bad_frames"] == 32);
}

TEST_CASE("source.udp refuses a scan in which an id stands twice, in parts or whole", "[source.udp]") {
    Received r("idle: 3600 s, bad_frames: skip");
    const auto part = [](std::uint64_t sequence, const std::string& numbers) {
        return "{\"pelorus\":1,\"kind\":\"scan\",\"sender\":\"mast\",\"sequence\":" + std::to_string(sequence) +
               ",\"time\":1,\"sensor\":\"radar\",\"measurements\":[[1]],\"ids\":[5],\"part\":" + numbers + "}";
    };
    r.take(part(0, "[1,2]")), r.take(part(1, "[2,2]"));
    r.emit_all();
    CHECK(r.bench.published.empty());
    CHECK(r.logged("the frame at 1000000000 ns has the id 5 twice"));
    CHECK(r.bench.counters["bad_frames"] == 1);
}

TEST_CASE("source.udp stamps the wall clock where it shall", "[source.udp]") {
    Received r("idle: 3600 s, arrival: clock");
    r.take(scan(5));
    r.stage->next();
    const plr_next next = r.stage->next();
    CHECK(next.what == PLR_NEXT_DATA);
    CHECK(next.time == 5'000'000'000);
    CHECK(next.arrival > 1'600'000'000'000'000'000);
}

TEST_CASE("source.udp leaves datagrams in the socket while too much is pending", "[source.udp]") {
    Received r("idle: 3600 s, maximum_pending: 65536");
    r.stage->next();
    std::string many;
    for (int i = 0; i < 3000; ++i) many += (i == 0 ? "[" : ",[") + std::to_string(i) + "]";
    for (std::uint64_t k = 0; k < 8; ++k)
        send(r.port(), "{\"pelorus\":1,\"kind\":\"scan\",\"sequence\":" + std::to_string(k) +
                           ",\"time\":1,\"sensor\":\"radar\",\"sender\":\"a\",\"measurements\":[" + many + "]}");
    r.stage->next();
    const auto read = r.bench.counters["datagrams"];
    CHECK(read >= 1);
    CHECK(read < 8);
    CHECK(r.emit_all().what == PLR_NEXT_WAIT);
    CHECK(r.bench.counters["datagrams"] == 8);
    CHECK(r.bench.published.size() == 8);
}

TEST_CASE("source.udp holds datagrams back only as far as maximum_pending goes", "[source.udp]") {
    const auto lost = [](const std::string& limit) {
        Received r("idle: 3600 s, senders: 0, reorder: 3600 s, maximum_pending: " + limit);
        const std::string line = "{\"pelorus\":1,\"kind\":\"end\",\"sender\":\"mast\",\"sequence\":1}\n";
        std::string bytes;
        while (bytes.size() + line.size() <= 65507) bytes += line;
        r.take(bytes, std::numeric_limits<std::int64_t>::max());  // so that it never waits for too long
        r.stage->next();
        return r.bench.counters["lost"];
    };
    CHECK(lost("65536") == 1);
    CHECK(lost("67108864") == 0);
}

TEST_CASE("source.udp tells apart only so many senders", "[source.udp]") {
    Received r("idle: 3600 s, maximum_senders: 1");
    r.take(scan(0));
    r.take("{\"pelorus\":1,\"kind\":\"end\",\"sender\":\"other\"}");
    CHECK(r.logged("there are 1 senders already (maximum_senders)"));
    r.stage->next();
    CHECK(r.bench.counters["refused_datagrams"] == 1);
}

TEST_CASE("source.udp goes on from saved state, and counts what was sent in between as lost", "[source.udp]") {
    constexpr std::int64_t later = std::numeric_limits<std::int64_t>::max();  // so that nothing is waited for too long
    Received first("idle: 3600 s");
    first.take(scan(0)), first.take(scan(1)), first.take(scan(3), later);
    first.stage->next();
    first.stage->emit(first.stage->next().arrival);
    const auto state = first.stage->save();
    Received second("idle: 3600 s, reorder: 3600 s, reorder_datagrams: 1");
    second.stage->load(state);
    second.take(scan(5), later);
    second.emit_all();
    std::vector<std::int64_t> times;
    for (const Published& p : second.bench.published) times.push_back(p.message->time / 1'000'000'000);
    CHECK(times == std::vector<std::int64_t>{1, 3});
    CHECK(second.bench.published[0].scan().ids[0] == 3);
    second.take(scan(6)), second.take(scan(7));
    second.emit_all();
    CHECK(second.bench.counters["lost"] == 2);
}

TEST_CASE("source.udp refuses parameters that make no sense before any socket is opened", "[source.udp]") {
    const std::vector<std::pair<std::string, std::string>> cases{
        {"address: localhost", "address: 'localhost' is no IP address in numbers"},
        {"address: 239.0.0.1", "address: '239.0.0.1' is no IP address in numbers"},
        {"multicast: 127.0.0.1", "multicast: '127.0.0.1' is no multicast group"},
        {"multicast: 239.0.0.1", "port: 0 chooses a port, which a group cannot know"},
        {"multicast: 239.0.0.1, address: 127.0.0.1", "address: with multicast, the group is what is listened to"},
        {"interface: lo", "interface: belongs to multicast, which is not given"},
    };
    for (const auto& [with, expected] : cases) {
        INFO(with);
        CHECK_THROWS_WITH(Received(with), Catch::StartsWith(expected));
    }
}

TEST_CASE("source.udp tells why it cannot listen", "[source.udp]") {
    Received taken("idle: 3600 s");
    taken.stage->next();
    const std::string port = std::to_string(taken.port());
    Bench bench;
    const auto sensor = std::make_shared<Instance>(bench, installed("sensor.position"), "{noise: 1 m}");
    const auto next = [&](const std::string& with) {
        StageUnderTest(bench, plugin_of<UdpSource>("source.udp"), with,
                       std::vector<Instance::Part>{{"sensors", "radar", sensor, "{}"}})
            .next();
    };
    CHECK_THROWS_WITH(
        next("{port: " + port + "}"),
        "parameters address and port: cannot listen on 127.0.0.1, UDP port " + port + ": Address already in use");
    CHECK_THROWS_WITH(next("{port: 0, address: 192.0.2.77}"),
                      "parameters address and port: cannot listen on 192.0.2.77, UDP port 0: Cannot assign requested "
                      "address");
    CHECK_THROWS_WITH(next("{port: 4530, multicast: 239.0.0.1, interface: nosuch0}"),
                      "parameter interface: there is no network interface nosuch0: No such device");
}
