#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include <catch2/catch.hpp>
#include <pelorus/messages.hpp>

#include "decode.hpp"
#include "encode.hpp"

namespace {

using wire::Envelope;
using wire::Frame;

const pelorus::Space polar({{"range", "m"}, {"azimuth", "rad", 0, 0, true}});
const pelorus::Space waveform(std::vector<pelorus::Component>{{"bandwidth", "Hz"}});

wire::Vocabulary vocabulary() {
    wire::Vocabulary all;
    all.sensors["radar"] = {polar, waveform};
    all.sensors["gps"] = {pelorus::position_space(1), pelorus::Space()};
    all.truth = pelorus::kinematic_space(1, {0.0, 0.0});
    return all;
}

wire::Datagram decoded(const std::string& bytes) {
    wire::Datagram datagram;
    wire::decode(bytes, vocabulary(), datagram);
    return datagram;
}

/// The message of several datagrams, put together again.
Frame whole(const wire::Datagrams& datagrams) {
    std::optional<Frame> frame;
    for (const std::string& bytes : datagrams) {
        const wire::Datagram part = decoded(bytes);
        REQUIRE(part.frames.size() == 1);
        if (!frame)
            frame = part.frames[0];
        else
            REQUIRE(append(*frame, part.frames[0]));
    }
    return *frame;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// Doubles of every size and sign.
std::vector<double> awkward(std::size_t count) {
    using limits = std::numeric_limits<double>;
    std::vector<double> values{0.0,
                               -0.0,
                               5.0,
                               -7.0,
                               0.1,
                               1e22,
                               1e23,
                               9007199254740993.0,
                               12345678901234567890.0,
                               limits::max(),
                               limits::min(),
                               limits::denorm_min(),
                               -limits::max(),
                               limits::epsilon(),
                               1.0 / 3};
    std::mt19937_64 random(7);
    while (values.size() < count) {
        const std::uint64_t bits = random();
        double value = 0;
        std::memcpy(&value, &bits, sizeof value);
        if (std::isfinite(value)) values.push_back(value);
    }
    return values;
}

}  // namespace

TEST_CASE("Doubles come out of the wire bit for bit as they went in, as JSON and as CSV, in parts or whole", "[wire]") {
    const std::vector<double> values = awkward(2000);
    pelorus::ScanBuilder scan("radar", "", polar);
    for (std::size_t i = 0; i + 1 < values.size(); i += 2) {
        scan.add(1000 + i, values.data() + i);
        scan.set_time(static_cast<std::int64_t>(i) - 5);
        scan.set_snr(std::abs(values[i]));
    }
    const plr_scan& message = *scan.message(12).body.scan;
    for (const auto encode : {&wire::json_scan, &wire::csv_scan})
        for (const std::size_t maximum : {std::size_t{400}, std::size_t{1400}, std::size_t{65000}}) {
            Envelope envelope{"a", 3, 17};
            const wire::Datagrams datagrams = encode(envelope, {12, -13}, message, maximum);
            CHECK(envelope.sequence == 17 + datagrams.size());
            CHECK(datagrams.size() > 1);
            for (const std::string& bytes : datagrams) CHECK(bytes.size() <= maximum);
            const wire::Datagram last = decoded(datagrams.back());
            CHECK(last.sender == "a");
            CHECK(last.session == 3);
            CHECK(last.sequence == envelope.sequence - 1);
            const Frame frame = whole(datagrams);
            CHECK(frame.time == 12);
            CHECK(frame.arrival == -13);
            CHECK(frame.part[0] == frame.part[1]);
            CHECK(same_bits(frame.values, values));
            REQUIRE(frame.ids.size() == frame.rows());
            CHECK(frame.ids.back() == 1000 + values.size() - 2);
            CHECK(frame.times.at(3) == 1);
            CHECK(frame.snr.at(2) == std::abs(values[4]));
        }
}

TEST_CASE("Covariances come out of the wire as they went in, each or common", "[wire]") {
    const double z[] = {1, 2}, each[] = {4, 0.1, 0.1, 1.0 / 3, 9, -1, -1, 0.7};
    pelorus::ScanBuilder scan("radar", "", polar);
    scan.add(1, z, each);
    scan.add(2, z, each + 4);
    scan.set_waveform(waveform, {3e6});
    plr_scan message = *scan.message(0).body.scan;
    Envelope envelope{"a"};
    Frame frame = whole(wire::json_scan(envelope, {}, message, 65000));
    CHECK(same_bits(frame.covariances, std::vector<double>(each, each + 8)));
    CHECK_FALSE(frame.common_covariance());
    CHECK(frame.waveform == std::vector<double>{3e6});
    CHECK_THROWS_WITH(wire::csv_scan(envelope, {}, message, 65000), Catch::Contains("use format: json"));

    message.covariances.item_stride = 0;
    frame = whole(wire::json_scan(envelope, {}, message, 65000));
    CHECK(same_bits(frame.covariances, std::vector<double>(each, each + 4)));
    CHECK(frame.common_covariance());

    message.covariances.item_stride = 4;
    message.waveform.data = nullptr;
    frame = whole(wire::csv_scan(envelope, {}, message, 65000));
    CHECK(same_bits(frame.covariances, std::vector<double>(each, each + 8)));
}

TEST_CASE("A common covariance stays common in parts of one row and of more", "[wire]") {
    std::optional<Frame> frame;
    const std::string measurements[] = {"[[1,0]]", "[[2,0]]", "[[3,0],[4,0]]"};
    for (int i = 0; i < 3; ++i) {
        const std::string number = std::to_string(i + 1);
        const wire::Datagram part = decoded(
            "{\"pelorus\":1,\"kind\":\"scan\",\"sequence\":" + number + ",\"time\":0,\"sensor\":\"radar\",\"part\":[" +
            number + ",3],\"covariance\":[[4,1],[1,9]],\"measurements\":" + measurements[i] + "}");
        REQUIRE(part.frames.at(0).common_covariance());
        if (!frame)
            frame = part.frames[0];
        else
            REQUIRE(append(*frame, part.frames[0]));
    }
    CHECK(frame->rows() == 4);
    CHECK(frame->common_covariance());
    CHECK(frame->covariances == std::vector<double>{4, 1, 1, 9});
}

TEST_CASE("Truth comes out of the wire as it went in", "[wire]") {
    pelorus::TruthBuilder truth("", pelorus::kinematic_space(1, {0.0, 0.0}), 1);
    for (std::uint64_t id = 1; id < 40; ++id) {
        const double state[] = {1.0 / static_cast<double>(id), -3}, extent[] = {0.25};
        pelorus::TruthEntry entry;
        entry.id = ~std::uint64_t{0} - id;  // beyond what a double holds
        entry.time = static_cast<std::int64_t>(id);
        entry.state = state;
        entry.extent = extent;
        entry.parent = entry.id;
        entry.birth = -1;
        if (id % 2 == 0) entry.measurements = {id, 7};
        truth.add(entry);
    }
    Envelope envelope{"a"};
    const wire::Datagrams datagrams = wire::json_truth(envelope, {5, 6}, *truth.message(5).body.truth, 1400);
    CHECK(datagrams.size() > 1);
    const Frame frame = whole(datagrams);
    CHECK(frame.kind == wire::Kind::truth);
    REQUIRE(frame.rows() == 39);
    CHECK(frame.values[2 * 2] == 1.0 / 3);
    CHECK(frame.ids[0] == ~std::uint64_t{0} - 1);
    CHECK(frame.times[4] == 5);
    CHECK(frame.extent_dimension == 1);
    CHECK(frame.extents.size() == 39);
    CHECK(frame.births[0] == -1);
    CHECK(frame.measurements[1] == std::vector<std::uint64_t>{2, 7});
    CHECK(frame.measurements[2].empty());
}

TEST_CASE("A scan without measurements and the end come through in both formats", "[wire]") {
    pelorus::ScanBuilder scan("radar", "", polar);
    const plr_scan& message = *scan.message(0).body.scan;
    Envelope envelope{"a"};
    for (const auto encode : {&wire::json_scan, &wire::csv_scan}) {
        const Frame frame = whole(encode(envelope, {8, 9}, message, 1400));
        CHECK(frame.rows() == 0);
        CHECK(frame.sensor == "radar");
        CHECK(frame.time == 8);
    }
    CHECK(decoded(wire::json_end(envelope)).frames.at(0).kind == wire::Kind::end);
    CHECK(decoded(wire::csv_end(envelope)).frames.at(0).kind == wire::Kind::end);
    CHECK(envelope.sequence == 4);
}

TEST_CASE("Frames written by hand need little, and times in seconds do", "[wire]") {
    const wire::Datagram datagram = decoded(
        "{\"pelorus\": 1, \"kind\": \"scan\", \"time\": 1.5, \"sensor\": \"radar\", \"measurements\": [[1000, 0.1]], "
        "\"x-note\": \"mine\"}\r\n\r\n"
        "{\"pelorus\": 1, \"kind\": \"scan\", \"time\": 2, \"sensor\": \"gps\", \"measurements\": [[3], [4]]}");
    REQUIRE(datagram.frames.size() == 2);
    CHECK(datagram.sender.empty());
    CHECK_FALSE(datagram.sequence);
    CHECK(datagram.frames[0].time == 1'500'000'000);
    CHECK_FALSE(datagram.frames[0].arrival);
    CHECK(datagram.frames[1].values == std::vector<double>{3, 4});
    CHECK(datagram.frames[1].ids.empty());

    const wire::Datagram rows = decoded(
        "pelorus,time,sensor,azimuth,range,deviation.range,deviation.azimuth,position.x\n"
        "1,0.5,radar,0.1,1000,2,0.5,\n"
        "1,0.5,\"radar\",0.2,1001,2,0.5,\n"
        "1,0.5,gps,,,,,7\n");
    REQUIRE(rows.frames.size() == 2);
    CHECK(rows.frames[0].values == std::vector<double>{1000, 0.1, 1001, 0.2});  // by name, in the sensor's order
    CHECK(rows.frames[0].covariances == std::vector<double>{4, 0, 0, 0.25, 4, 0, 0, 0.25});
    CHECK(rows.frames[1].values == std::vector<double>{7});
}

TEST_CASE("What the wire cannot carry is refused when it is sent", "[wire]") {
    const double bad[] = {1, std::numeric_limits<double>::quiet_NaN()};
    pelorus::ScanBuilder scan("radar", "", polar);
    scan.add(1, bad);
    Envelope envelope{"a"};
    CHECK_THROWS_WITH(wire::json_scan(envelope, {}, *scan.message(0).body.scan, 1400),
                      "measurements[0] is not finite, and the wire carries finite numbers only");
    CHECK_THROWS_AS(wire::csv_scan(envelope, {}, *scan.message(0).body.scan, 1400), pelorus::DataError);
    CHECK(envelope.sequence == 0);

    pelorus::ScanBuilder wide("radar", "", polar);
    wide.add(1, awkward(2).data());
    CHECK_THROWS_WITH(wire::json_scan(envelope, {}, *wide.message(0).body.scan, 100),
                      Catch::Contains("bytes, maximum_datagram is 100"));
}

TEST_CASE("Parts that do not belong together are not put together", "[wire]") {
    Frame one;
    one.width = 1;
    one.part = {1, 3};
    one.values = {1};
    one.ids = {1};
    Frame two = one;
    two.part = {2, 3};
    const auto refused = [&](auto change) {
        Frame first = one, second = two;
        change(second);
        const bool taken = append(first, second);
        CHECK(first.rows() == (taken ? 2 : 1));
        return !taken;
    };
    CHECK_FALSE(refused([](Frame&) {}));
    CHECK(refused([](Frame& f) { f.part[0] = 3; }));
    CHECK(refused([](Frame& f) { f.part[1] = 4; }));
    CHECK(refused([](Frame& f) { f.time = 1; }));
    CHECK(refused([](Frame& f) { f.sensor = "other"; }));
    CHECK(refused([](Frame& f) { f.ids.clear(); }));
    CHECK(refused([](Frame& f) { f.snr = {1}; }));
    CHECK(refused([](Frame& f) { f.covariances = {1}; }));
    one.covariances = {1}, two.covariances = {1};
    CHECK(refused([](Frame& f) { f.common = true; }));
    one.common = two.common = true;
    CHECK_FALSE(refused([](Frame&) {}));
    CHECK(refused([](Frame& f) { f.covariances = {2}; }));
}
