// A recording over UDP: one run sends it, another one receives it, over a loopback.
//
// Nothing here depends on time or luck: a loopback loses datagrams only when a receive buffer is full, and the buffers here
// hold all that is ever sent.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "../fixtures/temporary_folder.hpp"
#include "../support/process.hpp"

using namespace pelorus::test;

namespace {

using Words = std::vector<std::string>;

const std::string configs = std::string(PELORUS_SOURCE_DIR) + "/configs/";
const Words short_recording{"--set", "radar.duration=60 s"};  // 31 scans, 62 datagrams and the end
constexpr std::size_t usual = 1400;  // bytes of a datagram at most, unless maximum_datagram says otherwise
const Words small_buffer{"--set", "radar.receive_buffer=212992"};  // what Linux gives unless it is told to give more

/// Bytes of a receive buffer that a datagram takes, at most. The system counts what it allocates: a block of 2^n bytes for the
/// data, with headers and its own record behind (less than 512 bytes), and a descriptor (less than 512). Measured on Linux 6:
/// 832 for 1 byte, 1280 for 500, 2304 for 1400.
constexpr std::size_t charged(std::size_t datagram) {
    std::size_t block = 512;
    while (block < datagram + 512) block *= 2;
    return block + 512;
}

Words operator+(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

sockaddr_in loopback(int port) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    at.sin_port = htons(static_cast<std::uint16_t>(port));
    return at;
}

/// Keeps all datagrams that come in until somebody asks for them.
class Relay {
public:
    Relay() : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        const int wanted = 4 << 20;
        sockaddr_in at = loopback(0);
        socklen_t size = sizeof at, length = sizeof buffer_;
        ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
        if (::bind(descriptor_, reinterpret_cast<const sockaddr*>(&at), size) != 0 ||
            ::getsockname(descriptor_, reinterpret_cast<sockaddr*>(&at), &size) != 0 ||
            ::getsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &buffer_, &length) != 0)
            throw std::runtime_error("no socket");
        port_ = ntohs(at.sin_port);
    }
    ~Relay() { ::close(descriptor_); }
    Relay(const Relay&) = delete;
    Relay& operator=(const Relay&) = delete;
    std::string port() const { return std::to_string(port_); }
    bool holds(std::size_t datagrams) const { return static_cast<std::size_t>(buffer_) >= datagrams * charged(usual); }

    std::vector<std::string> received() const {
        std::vector<std::string> all;
        std::string bytes(65536, 0);
        for (ssize_t n; (n = ::recv(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT)) >= 0;)
            all.push_back(bytes.substr(0, static_cast<std::size_t>(n)));
        return all;
    }
    void send(int port, const std::string& bytes) const {
        const sockaddr_in to = loopback(port);
        REQUIRE(::sendto(descriptor_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                         sizeof to) == static_cast<ssize_t>(bytes.size()));
    }

private:
    int descriptor_, port_ = 0, buffer_ = 0;
};

/// The number that stands behind a text.
int number_after(const std::string& text, const std::string& words) {
    const auto at = text.find(words);
    return at == std::string::npos ? 0 : std::stoi(text.substr(at + words.size()));
}

/// A run of configs/recorded_radar_udp.yaml that listens on a port which the system chose.
class Receiver {
public:
    explicit Receiver(const std::string& out, const Words& more = {})
        : process_(Words{PELORUS_EXECUTABLE, "run", configs + "recorded_radar_udp.yaml", "--out", out, "--set",
                         "radar.port=0"} +
                       more,
                   {{}, {{"PELORUS_PLUGIN_PATH", ""}}}) {
        for (std::string said; port_ == 0 && process_.running();) {
            said = process_.errors();
            if (said.find("bytes\n") == std::string::npos) {
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
                continue;
            }
            port_ = number_after(said, "UDP port ");
            buffer_ = number_after(said, "receive buffer ");
        }
        if (port_ == 0) FAIL(process_.wait().err);
    }
    int port() const { return port_; }
    /// Whether so many datagrams fit into its buffer (which the system makes twice as large as it says).
    bool holds(std::size_t datagrams, std::size_t size = usual) const {
        return 2 * static_cast<std::size_t>(buffer_) >= datagrams * charged(size);
    }
    void interrupt() const { process_.send(SIGINT); }
    Ended wait() { return process_.wait(); }

private:
    Process process_;
    int port_ = 0, buffer_ = 0;
};

/// Runs configs/replay_radar_udp.yaml at full speed; answers how many datagrams it sent.
std::size_t replay(const TemporaryFolder& folder, const std::string& port, const Words& more) {
    const Ended ended =
        pelorus_command(Words{"run", configs + "replay_radar_udp.yaml", "--out", folder / "replay", "--set",
                              "sender.pace=0", "--set", "sender.destination=127.0.0.1:" + port} +
                        more);
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
    const auto timing = nlohmann::json::parse(folder.read("replay/timing.json"));
    return timing["nodes"]["sender"]["counters"]["datagrams"].get<std::size_t>();
}

nlohmann::json counters(const TemporaryFolder& folder) {
    return nlohmann::json::parse(folder.read("live/timing.json"))["nodes"]["radar"]["counters"];
}

void run_from_file(const TemporaryFolder& folder, const Words& more) {
    const Ended ended = pelorus_command(Words{"run", configs + "recorded_radar.yaml", "--out", folder / "file"} + more);
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
}

}  // namespace

TEST_CASE("A recording replayed over UDP gives the results of the file, byte for byte", "[udp]") {
    for (const std::size_t size : {usual, std::size_t{500}}) {
        const TemporaryFolder folder;
        Receiver receiver(folder / "live", size == usual ? Words{} : small_buffer);
        // A small buffer takes a part of the recording only; the system may give no other.
        const Words part = receiver.holds(1000) ? Words{} : short_recording;
        const std::size_t sent = replay(folder, std::to_string(receiver.port()),
                                        part + Words{"--set", "sender.maximum_datagram=" + std::to_string(size)});
        REQUIRE(receiver.holds(sent, size));
        const Ended ended = receiver.wait();
        INFO(ended.err);
        REQUIRE(ended.exit == 0);
        CHECK(count(ended.err, "0 bad, 0 lost, 0 late, 0 duplicate, 0 incomplete, 0 refused") == 1);
        run_from_file(folder, part);
        for (const std::string file : {"tracks.csv", "truth.csv", "summary.json"}) {
            INFO(file);
            CHECK(folder.read("live/" + file) == folder.read("file/" + file));
        }
        CHECK(count(folder.read("live/tracks.csv"), "\n") > 100);
    }
}

TEST_CASE("A recording replayed as CSV frames gives the tracks of the file, byte for byte", "[udp]") {
    const TemporaryFolder folder;
    Receiver receiver(folder / "live", {"--set", "errors=~", "--set", "identity=~", "--set", "files.in.truth=~",
                                        "--set", "radar.truth=none"});
    const std::size_t sent =
        replay(folder, std::to_string(receiver.port()),
               short_recording + Words{"--set", "sender.format=csv", "--set", "sender.in.truth=~"});
    REQUIRE(receiver.holds(sent));
    const Ended ended = receiver.wait();
    INFO(ended.err);
    REQUIRE(ended.exit == 0);
    run_from_file(folder, short_recording);
    CHECK(folder.read("live/tracks.csv") == folder.read("file/tracks.csv"));
}

TEST_CASE("Datagrams that are lost, doubled, swapped and late are treated by policy and counted", "[udp]") {
    const TemporaryFolder folder;
    const Relay relay;
    REQUIRE(relay.holds(70));
    REQUIRE(replay(folder, relay.port(), short_recording) == 65);
    std::vector<std::string> datagrams = relay.received();
    REQUIRE(datagrams.size() == 65);
    std::vector<std::string> sent;
    for (std::size_t k = 0; k < 62; ++k) {
        if (k == 5 || k == 11) continue;
        sent.push_back(datagrams[k == 30 ? 31 : k == 31 ? 30 : k]);
        if (k == 20) sent.push_back(datagrams[k]);
    }
    sent.push_back(datagrams[5]);
    sent.push_back("what is this");
    sent.insert(sent.end(), datagrams.begin() + 62, datagrams.end());
    // Missing datagrams are given up when four have come after them, however long that takes.
    const Words order{"--set", "radar.reorder=3600 s", "--set", "radar.reorder_datagrams=4"};

    const auto run_with = [&](const Words& policies) {
        Receiver receiver(folder / "live", order + policies);
        REQUIRE(receiver.holds(sent.size()));
        for (const std::string& bytes : sent) relay.send(receiver.port(), bytes);
        return receiver.wait();
    };
    const Ended lenient = run_with({"--set", "radar.bad_frames=skip"});
    INFO(lenient.err);
    REQUIRE(lenient.exit == 0);
    for (const std::string line :
         {"): datagram 5 is lost\n", "): datagram 11 is lost\n", "): datagram 20 came again; it is left out\n",
          "): datagram 5 came after it had been given up; it is left out\n",
          "): line 1: begins with neither { nor the column pelorus, but with 'what is this'; it is left out\n"}) {
        INFO(line);
        CHECK(count(lenient.err, line) == 1);
    }
    CHECK(count(lenient.err, "127.0.0.1:" + relay.port() + ", datagram 63 (sender 127.0.0.1:") == 1);
    CHECK(count(lenient.err, "1 bad, 1 lost, 1 late, 1 duplicate, 0 incomplete, 0 refused") == 1);
    const auto counted = counters(folder);
    CHECK(counted["lost"] == 1);
    CHECK(counted["late"] == 1);
    CHECK(counted["duplicates"] == 1);
    CHECK(counted["bad_frames"] == 1);

    const std::vector<std::pair<Words, std::string>> strict{
        {{"--set", "radar.lost=stop"}, "): datagram 5 is lost (lost: count would go on)"},
        {{"--set", "radar.late=stop"},
         "): datagram 5 came after it had been given up (late: drop or keep would go on)"},
        {{"--set", "radar.late=drop"}, "but with 'what is this' (bad_frames: skip would go on)"}};
    for (const auto& [policy, expected] : strict) {
        const Ended ended = run_with(policy);
        INFO(ended.err);
        CHECK(ended.exit == 1);
        CHECK(count(ended.err, "pelorus: node radar (source.udp), next at ") == 1);
        CHECK(count(ended.err, expected) == 1);
        CHECK(count(folder.read("live/tracks.csv"), "\n") >= 1);  // what there was is kept
    }
}

TEST_CASE("A run that waits for datagrams ends at once when it is told to, and keeps its results", "[udp]") {
    const TemporaryFolder folder;
    Receiver receiver(folder / "live");
    receiver.interrupt();
    const Ended ended = receiver.wait();
    CHECK(ended.exit == 1);
    CHECK(count(ended.err, "stopped by SIGINT") == 1);
    CHECK(count(ended.err, "0 datagrams, 0 frames") == 1);
    CHECK(std::filesystem::exists(folder / "live/summary.json"));
}

TEST_CASE("Checking a config binds no socket", "[udp]") {
    const TemporaryFolder folder;
    Receiver receiver(folder / "live");
    const std::string port = std::to_string(receiver.port());
    const Words set{"--set", "radar.port=" + port};
    CHECK(pelorus_command(Words{"check", configs + "recorded_radar_udp.yaml"} + set).exit == 0);
    const Ended second =
        pelorus_command(Words{"run", configs + "recorded_radar_udp.yaml", "--out", folder / "second"} + set);
    CHECK(second.exit == 1);
    CHECK(count(second.err, "parameters address and port: cannot listen on 127.0.0.1, UDP port " + port +
                                ": Address already in use") == 1);
    receiver.interrupt();
    CHECK(receiver.wait().exit == 1);
}

TEST_CASE("The sender in Python that docs/wire-format.md shows does what it says", "[udp]") {
    if (run({"sh", "-c", "command -v python3"}).exit != 0) {
        WARN("skipped: there is no python3");
        return;
    }
    const TemporaryFolder folder;
    const std::string page = read_file(std::string(PELORUS_SOURCE_DIR) + "/docs/wire-format.md"),
                      fence = "```python file=sender.py\n";
    const auto begin = page.find(fence) + fence.size();
    const std::string script = folder.write("sender.py", page.substr(begin, page.find("```", begin) - begin));
    Receiver receiver(folder / "live");
    const Ended python = run({"python3", script, std::to_string(receiver.port())});
    INFO(python.err);
    REQUIRE(python.exit == 0);
    const Ended ended = receiver.wait();
    INFO(ended.err);
    CHECK(ended.exit == 0);
    CHECK(count(ended.err, "11 datagrams, 11 frames, 10 rows, 0 bad, 0 lost") == 1);
    CHECK(count(folder.read("live/tracks.csv"), ",confirmed,") >= 1);
}
