#include "udp_sink.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../../../tests/fixtures/stage_bench.hpp"

namespace {

using namespace pelorus::test;
using nlohmann::json;
using sink_udp::UdpSink;

/// Somebody who listens on a port of a loopback.
class Listener {
public:
    Listener() : descriptor_(::socket(AF_INET, SOCK_DGRAM, 0)) {
        sockaddr_in at{};
        at.sin_family = AF_INET;
        at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof at;
        const timeval patience{30, 0};
        if (::bind(descriptor_, reinterpret_cast<const sockaddr*>(&at), size) != 0 ||
            ::getsockname(descriptor_, reinterpret_cast<sockaddr*>(&at), &size) != 0 ||
            ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) != 0)
            throw std::runtime_error("no socket");
        port_ = ntohs(at.sin_port);
    }
    ~Listener() { ::close(descriptor_); }
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    /// Takes from now on what comes from itself alone: the system answers all else as if nobody listened, and gives the
    /// port to nobody.
    void turn_away() const {
        sockaddr_in self{};
        socklen_t size = sizeof self;
        REQUIRE(::getsockname(descriptor_, reinterpret_cast<sockaddr*>(&self), &size) == 0);
        REQUIRE(::connect(descriptor_, reinterpret_cast<const sockaddr*>(&self), size) == 0);
    }
    std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
    std::string next() const {
        std::string bytes(65536, 0);
        const ssize_t size = ::recv(descriptor_, bytes.data(), bytes.size(), 0);
        REQUIRE(size >= 0);
        return bytes.substr(0, static_cast<std::size_t>(size));
    }

private:
    int descriptor_;
    int port_ = 0;
};

std::unique_ptr<StageUnderTest> sink(Bench& bench, const std::string& destination, const std::string& more = "") {
    return std::make_unique<StageUnderTest>(bench, plugin_of<UdpSink>("sink.udp"),
                                            "{destination: \"" + destination + "\"" + more + "}");
}

enum Port : std::uint32_t { scans, truth, tracks };

}  // namespace

TEST_CASE("sink.udp sends each message in its own datagram, and the end several times", "[sink.udp]") {
    const Listener listener;
    Bench bench;
    const auto stage = sink(bench, listener.address(), ", repeat_end: 2, sender: mast");
    pelorus::ScanBuilder scan("radar", "", pelorus::position_space(2));
    const double z[] = {0.1, -0.0};
    scan.add(7, z);
    stage->receive(scans, scan.message(3), 4);
    stage->finish();
    const std::string bytes = listener.next();
    const json frame = json::parse(bytes);
    CHECK(bytes.back() == '\n');
    CHECK_THAT(bytes, Catch::Contains("\"measurements\":[[0.1,-0.0]]"));
    CHECK(frame["pelorus"] == 1);
    CHECK(frame["kind"] == "scan");
    CHECK(frame["sender"] == "mast");
    CHECK(frame["session"] > 0);
    CHECK(frame["sequence"] == 0);
    CHECK(frame["time_ns"] == 3);
    CHECK(frame["arrival_ns"] == 4);
    CHECK(frame["sensor"] == "radar");
    CHECK(frame["components"] == json{"position.x", "position.y"});
    CHECK(frame["ids"] == json{7});
    CHECK(frame.count("part") == 0);
    for (int i = 0; i < 2; ++i) {
        const json end = json::parse(listener.next());
        CHECK(end["kind"] == "end");
        CHECK(end["sequence"] == 1);
    }
    CHECK(bench.counters["datagrams"] == 3);
}

TEST_CASE("sink.udp sends tracks so that a display can show them", "[sink.udp]") {
    const double mean[] = {1, 2}, covariance[] = {4, 1, 1, 9}, extent[] = {3};
    pelorus::TracksBuilder builder("ship", pelorus::kinematic_space(1, {0.0, 0.0}), 1);
    pelorus::TrackEntry entry;
    entry.id = 12;
    entry.time = 5;
    entry.status = PLR_TRACK_COASTING;
    entry.misses = 2;
    entry.mean = mean, entry.covariance = covariance, entry.extent = extent;
    entry.measurements = {8};
    builder.add(entry);
    for (const std::string uncertainty : {"none", "deviations", "covariances"}) {
        const Listener listener;
        Bench bench;
        const auto stage = sink(bench, listener.address(), ", uncertainty: " + uncertainty);
        stage->receive(tracks, builder.message(5));
        const json frame = json::parse(listener.next());
        CHECK(frame["kind"] == "tracks");
        CHECK(frame["frame"] == "ship");
        CHECK(frame["components"] == json{"position.x", "velocity.x"});
        CHECK(frame["ids"] == json{12});
        CHECK(frame["times_ns"] == json{5});
        CHECK(frame["status"] == json{"coasting"});
        CHECK(frame["misses"] == json{2});
        CHECK(frame["means"] == json::parse("[[1,2]]"));
        CHECK(frame["extents"] == json::parse("[[[3]]]"));
        CHECK(frame["measurements"] == json::parse("[[8]]"));
        CHECK(frame.value("deviations", json()) == (uncertainty == "deviations" ? json::parse("[[2,3]]") : json()));
        CHECK(frame.value("covariances", json()) ==
              (uncertainty == "covariances" ? json::parse("[[[4,1],[1,9]]]") : json()));
    }
}

TEST_CASE("sink.udp writes CSV where it shall, of scans only", "[sink.udp]") {
    const Listener listener;
    Bench bench;
    const auto stage = sink(bench, listener.address(), ", format: csv");
    pelorus::ScanBuilder scan("radar", "", pelorus::position_space(1));
    const double z = 0.1;
    scan.add(7, &z);
    stage->receive(scans, scan.message(3), 4);
    const std::string bytes = listener.next();
    CHECK_THAT(bytes, Catch::StartsWith("pelorus,kind,sender,session,sequence,sensor,time_ns,arrival_ns,id,position.x\n"
                                        "1,scan,pelorus,"));
    CHECK_THAT(bytes, Catch::EndsWith(",0,radar,3,4,7,0.1\n"));
    pelorus::TruthBuilder builder("", pelorus::position_space(1));
    CHECK_THROWS_WITH(stage->receive(truth, builder.message(3)),
                      "format: csv carries scans only; take format: json, or leave out the edge to port truth");
}

TEST_CASE("sink.udp goes on where nobody listens, says so once and counts", "[sink.udp]") {
    const Listener gone;
    gone.turn_away();
    Bench bench;
    const auto stage = sink(bench, gone.address(), ", send_errors: stop");
    pelorus::ScanBuilder scan("radar", "", pelorus::position_space(1));
    for (int i = 0; i < 5; ++i) stage->receive(scans, scan.message(i));
    stage->finish();
    CHECK(bench.counters["unreachable"] > 0);
    CHECK(bench.counters["send_errors"] == 0);
    std::size_t said = 0;
    for (const std::string& line : bench.log) said += line.find("nobody listens at") != std::string::npos;
    CHECK(said == 1);
}

TEST_CASE("sink.udp sends at once what would be due in centuries", "[sink.udp]") {
    const Listener listener;
    Bench bench;
    const auto stage = sink(bench, listener.address(), ", pace: 1");
    constexpr std::int64_t farthest = std::int64_t{1} << 62;
    pelorus::ScanBuilder scan("radar", "", pelorus::position_space(1));
    stage->receive(scans, scan.message(0), -farthest);
    stage->receive(scans, scan.message(0), farthest);
    CHECK(bench.counters["datagrams"] == 2);
}

TEST_CASE("sink.udp ends or goes on when the system does not send", "[sink.udp]") {
    pelorus::ScanBuilder scan("radar", "", pelorus::position_space(1));
    Bench bench;
    // A name with an empty label is none: nobody is asked for it.
    const auto strict = sink(bench, "host..invalid:1");
    CHECK_THROWS_WITH(strict->receive(scans, scan.message(0)),
                      Catch::StartsWith("parameter destination: cannot find host host..invalid: "));
    // A broadcast address is refused by the system unless a socket asks for it.
    const auto broadcast = sink(bench, "255.255.255.255:9");
    CHECK_THROWS_WITH(broadcast->receive(scans, scan.message(0)),
                      Catch::StartsWith("parameter destination: cannot send to 255.255.255.255, UDP port 9: "));
    const auto interface = sink(bench, "239.0.0.1:9", ", interface: nosuch0");
    CHECK_THROWS_WITH(interface->receive(scans, scan.message(0)),
                      "parameter interface: there is no network interface nosuch0");
}

TEST_CASE("sink.udp refuses what is no destination", "[sink.udp]") {
    Bench bench;
    for (const std::string text :
         {"localhost", ":4530", "localhost:", "localhost:0", "localhost:65536", "a:b", "::1:4530", "[::1:4530", "[]:1"})
        CHECK_THROWS_WITH(sink(bench, text), "destination: '" + text +
                                                 "' is no destination: expected host:port, as 127.0.0.1:4530 or "
                                                 "[::1]:4530, port 1 to 65535");
    CHECK(sink_udp::parse_destination("[::1]:4530")->host == "::1");
    CHECK(sink_udp::parse_destination("example.org:65535")->port == "65535");
    CHECK_THROWS_WITH(sink(bench, "a:1", ", sender: \"\""), "sender: is not 1 to 64 printable ASCII characters");
}

TEST_CASE("sink.udp that is resumed goes on with its numbers, in the same session", "[sink.udp]") {
    const Listener listener;
    Bench bench;
    pelorus::ScanBuilder scan("radar", "", pelorus::position_space(1));
    const auto first = sink(bench, listener.address());
    first->receive(scans, scan.message(0));
    const auto second = sink(bench, listener.address());
    second->load(first->save());
    second->receive(scans, scan.message(1));
    const json one = json::parse(listener.next()), two = json::parse(listener.next());
    CHECK(two["session"] == one["session"]);
    CHECK(two["sequence"] == 1);
}
