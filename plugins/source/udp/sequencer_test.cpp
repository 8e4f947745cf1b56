#include "sequencer.hpp"

#include <catch2/catch.hpp>
#include <pelorus/archive.hpp>

namespace {

using source_udp::Duplicates;
using source_udp::Late;
using source_udp::Lost;
using source_udp::OrderSettings;

/// A sequencer that is given scans of one measurement, the number of the datagram, and told the time by hand.
struct Ordered {
    std::vector<std::string> warnings;
    source_udp::Sequencer sequencer;

    explicit Ordered(OrderSettings settings)
        : sequencer(settings, [this](const std::string& text) { warnings.push_back(text); }) {}

    bool push(std::optional<std::uint64_t> sequence, std::int64_t now = 0, const std::string& sender = "mast",
              std::uint64_t session = 0) {
        return push(sequence, {1, 1}, static_cast<std::int64_t>(sequence.value_or(0)), now, sender, session);
    }
    bool push(std::optional<std::uint64_t> sequence, std::array<std::uint64_t, 2> part, std::int64_t time,
              std::int64_t now = 0, const std::string& sender = "mast", std::uint64_t session = 0) {
        wire::Frame frame;
        frame.width = 1;
        frame.time = time;
        frame.part = part;
        frame.values = {static_cast<double>(sequence.value_or(0))};
        return sequencer.push({sender, session, sequence, {frame}}, now);
    }
    bool end(std::uint64_t sequence, const std::string& sender = "mast") {
        wire::Frame frame;
        frame.kind = wire::Kind::end;
        return sequencer.push({sender, 0, sequence, {frame}}, 0);
    }
    /// The measurements of all that has become ready.
    std::vector<double> taken() {
        std::vector<double> values;
        while (!sequencer.ready().empty()) {
            const wire::Frame frame = sequencer.take();
            values.insert(values.end(), frame.values.begin(), frame.values.end());
        }
        return values;
    }
};

OrderSettings settings() {
    OrderSettings s;
    s.reorder_time = 100;
    s.reorder_datagrams = 3;
    s.maximum_senders = 2;
    s.maximum_measurements = 4;
    s.maximum_waiting = 1 << 20;
    return s;
}

using Values = std::vector<double>;

}  // namespace

TEST_CASE("Datagrams that overtook each other are put into order, the first ones too", "[source.udp]") {
    Ordered o(settings());
    o.push(1);
    CHECK(o.taken().empty());
    o.push(0);
    o.push(4), o.push(3), o.push(2);
    CHECK(o.taken() == Values{0, 1, 2, 3, 4});
    CHECK(o.sequencer.counts().lost == 0);
    CHECK(o.warnings.empty());
}

TEST_CASE("A missing datagram is given up after the time told, or when so many wait", "[source.udp]") {
    Ordered o(settings());
    o.push(0, 0), o.push(3, 10);
    o.sequencer.expire(109);
    CHECK(o.taken() == Values{0});
    o.sequencer.expire(110);
    CHECK(o.taken() == Values{3});
    CHECK(o.sequencer.counts().lost == 2);
    CHECK(o.warnings == std::vector<std::string>{"sender mast: datagrams 1 to 2 are lost"});
    for (const std::uint64_t k : {5u, 6u, 7u}) o.push(k, 110);
    CHECK(o.taken().empty());
    o.push(8, 110);
    CHECK(o.taken() == Values{5, 6, 7, 8});
    CHECK(o.sequencer.counts().lost == 3);
}

TEST_CASE("A second gap has its own time", "[source.udp]") {
    Ordered o(settings());
    o.push(0, 0), o.push(2, 0), o.push(4, 90);
    o.push(1, 95);  // the first gap closes; 3 is missing only since it was looked for
    CHECK(o.taken() == Values{0, 1, 2});
    o.sequencer.expire(100);
    CHECK(o.taken().empty());
    o.sequencer.expire(200);
    CHECK(o.taken() == Values{4});
}

TEST_CASE("A datagram that comes after it was given up is late, and no longer lost", "[source.udp]") {
    for (const Late policy : {Late::drop, Late::keep, Late::stop}) {
        OrderSettings s = settings();
        s.late = policy;
        Ordered o(s);
        o.push(0), o.push(4);
        o.sequencer.flush();
        CHECK(o.sequencer.counts().lost == 3);
        o.taken();
        if (policy == Late::stop) {
            CHECK_THROWS_WITH(
                o.push(2), "sender mast: datagram 2 came after it had been given up (late: drop or keep would go on)");
            continue;
        }
        o.push(2);
        CHECK(o.sequencer.counts().lost == 2);
        CHECK(o.sequencer.counts().late == 1);
        if (policy == Late::keep) {
            REQUIRE(o.sequencer.ready().size() == 1);
            CHECK(o.sequencer.ready().front().time == 2);
            CHECK(o.sequencer.ready().front().arrival == 4);  // arrivals do not fall
        }
        CHECK(o.taken() == (policy == Late::keep ? Values{2} : Values{}));
        o.push(2);  // now it is a duplicate
        CHECK(o.sequencer.counts().duplicate == 1);
        o.push(1), o.push(3);
        CHECK(o.sequencer.counts().lost == 0);
    }
}

TEST_CASE("A lost datagram ends the run where the config says so", "[source.udp]") {
    OrderSettings s = settings();
    s.lost = Lost::stop;
    Ordered o(s);
    o.push(0), o.push(2);
    CHECK_THROWS_WITH(o.sequencer.flush(), "sender mast: datagram 1 is lost (lost: count would go on)");
}

TEST_CASE("A datagram that comes again is dropped or kept, also while it waits", "[source.udp]") {
    for (const Duplicates policy : {Duplicates::drop, Duplicates::keep}) {
        OrderSettings s = settings();
        s.duplicates = policy;
        Ordered o(s);
        o.push(0), o.push(0), o.push(2), o.push(2), o.push(1);
        CHECK(o.sequencer.counts().duplicate == 2);
        CHECK(o.taken() == (policy == Duplicates::keep ? Values{0, 0, 1, 2} : Values{0, 1, 2}));
    }
}

TEST_CASE("A frame that arrived before one already published is late, whatever its number", "[source.udp]") {
    OrderSettings s = settings();
    s.late = Late::drop;
    Ordered o(s);
    o.push(0, {1, 1}, 50), o.push(1, {1, 1}, 40), o.push(2, {1, 1}, 60);
    CHECK(o.taken() == Values{0, 2});
    CHECK(o.sequencer.counts().late == 1);
    s.own_clock = true;  // then arrivals are of the clock here, which may be set back
    Ordered clocked(s);
    clocked.push(0, {1, 1}, 50), clocked.push(1, {1, 1}, 40);
    CHECK(clocked.sequencer.ready().back().arrival == 50);
    CHECK(clocked.taken() == Values{0, 1});
}

TEST_CASE("Parts are put together, and a frame that lacks one is left out and counted", "[source.udp]") {
    Ordered o(settings());
    o.push(0, {1, 2}, 7), o.push(1, {2, 2}, 7);
    CHECK(o.sequencer.ready().size() == 1);
    CHECK(o.taken() == Values{0, 1});
    o.push(2, {1, 3}, 8), o.push(4, {3, 3}, 8), o.push(5, {1, 1}, 9);
    o.sequencer.flush();
    CHECK(o.taken() == Values{5});
    CHECK(o.sequencer.counts().incomplete == 1);
    o.push(6, {1, 2}, 10), o.push(7, {1, 1}, 11);
    CHECK(o.taken() == Values{7});
    CHECK(o.sequencer.counts().incomplete == 2);
    o.push(8, {2, 2}, 12);
    CHECK(o.sequencer.counts().incomplete == 3);
    CHECK(o.taken().empty());
}

TEST_CASE("A frame of more measurements than allowed is never held in memory", "[source.udp]") {
    Ordered o(settings());
    for (std::uint64_t k = 0; k < 6; ++k) o.push(k, {k + 1, 6}, 1);
    CHECK(o.taken().empty());
    CHECK(o.sequencer.counts().incomplete == 1);
}

TEST_CASE("A sender that is restarted again and again without an end goes on being heard, and another one is refused",
          "[source.udp]") {
    OrderSettings s = settings();
    s.late = Late::keep;  // their clocks are not the point
    Ordered o(s);
    CHECK(o.push(0, 0, "radar"));
    for (std::uint64_t session = 1; session < 10; ++session) CHECK(o.push(session, 0, "mast", session));
    CHECK_FALSE(o.push(0, 0, "stranger"));
    CHECK(o.push(1, 0, "radar"));
    o.sequencer.flush();
    CHECK(o.taken().size() == 11);
}

TEST_CASE("Frames that are short on the wire are held back only as far as memory goes", "[source.udp]") {
    OrderSettings s = settings();
    s.reorder_datagrams = 64;
    s.maximum_senders = 16;
    Ordered o(s);
    wire::Frame end;
    end.kind = wire::Kind::end;
    for (std::uint64_t k = 0; k < 10; ++k)
        for (int sender = 0; sender < 16; ++sender) {
            o.sequencer.push({std::to_string(sender), 0, 2 * k + 2, std::vector<wire::Frame>(100, end)}, 0);
            CHECK(o.sequencer.waiting_bytes() <= s.maximum_waiting);
        }
    CHECK(o.sequencer.waiting_bytes() > s.maximum_waiting / 2);
    CHECK(o.sequencer.counts().lost > 0);
    o.sequencer.flush();
    CHECK(o.sequencer.counts().lost == 16 * 11);
    CHECK(o.sequencer.waiting_bytes() == 0);
}

TEST_CASE("The lists of a truth in parts are put together only as far as memory goes", "[source.udp]") {
    OrderSettings s = settings();
    s.maximum_measurements = 100000;
    Ordered o(s);
    wire::Frame part;
    part.kind = wire::Kind::truth;
    part.width = 1;
    part.values = {0};
    part.measurements = {std::vector<std::uint64_t>(1000)};
    for (std::uint64_t k = 0; k < 200; ++k) {
        part.part = {k + 1, 200};
        o.sequencer.push({"mast", 0, k, {part}}, 0);
        CHECK(o.sequencer.waiting_bytes() <= s.maximum_waiting);
    }
    CHECK(o.sequencer.ready().empty());
    CHECK(o.sequencer.counts().incomplete == 1);
    CHECK(o.warnings.back() ==
          "sender mast: the frame at 0.000 s cannot be put together from its 200 parts; it is left out");
    CHECK(o.sequencer.waiting_bytes() == 0);
}

TEST_CASE("The sender that has most waiting gives up first", "[source.udp]") {
    OrderSettings s = settings();
    s.maximum_measurements = 100000;
    Ordered o(s);
    wire::Frame part;
    part.width = 1;
    part.part = {1, 2};
    part.values.resize(100000);  // 0.8 MB
    o.sequencer.push({"large", 0, 0, {part}}, 0);
    part.values.resize(50000);
    o.sequencer.push({"small", 0, 0, {part}}, 0);
    CHECK(o.warnings == std::vector<std::string>{"sender large: of the frame at 0.000 s only 1 of 2 parts came before "
                                                 "too much was waiting (maximum_pending); it is left out"});
    part.part = {2, 2};
    o.sequencer.push({"small", 0, 1, {part}}, 0);
    REQUIRE(o.sequencer.ready().size() == 1);
    CHECK(o.sequencer.ready().front().rows() == 100000);
    CHECK(o.sequencer.counts().incomplete == 1);
}

TEST_CASE("Late datagrams that leave holes in a wide gap are told apart only as far as memory goes", "[source.udp]") {
    Ordered o(settings());
    o.push(0), o.push(100000);
    o.sequencer.flush();
    for (std::uint64_t k = 99998; k > 90000; k -= 2) o.push(k);
    CHECK(o.sequencer.counts().late > 200);
    CHECK(o.sequencer.counts().late < 300);
    CHECK(o.sequencer.counts().late + o.sequencer.counts().duplicate == 4999);
}

TEST_CASE("Senders and their sessions have numbers of their own, and a sender that has long been sending is joined",
          "[source.udp]") {
    Ordered o(settings());
    o.push(0), o.push(0, 0, "mast", 1);
    CHECK(o.taken() == Values{0, 0});
    CHECK_FALSE(o.push(0, 0, "third"));
    o.end(1);
    CHECK(o.sequencer.ended() == 1);
    CHECK(o.push(1000, 0, "third"));  // in the place of the one that ended
    CHECK(o.taken() == Values{1000});
    CHECK(o.sequencer.counts().lost == 0);
    CHECK(o.warnings.back() == "sender third is heard from datagram 1000 on; those before are not counted");
}

TEST_CASE("An end counts once, however often it is told, and no frame before it is passed over", "[source.udp]") {
    Ordered o(settings());
    o.push(0), o.end(2);
    CHECK(o.sequencer.ended() == 0);
    o.push(1);
    CHECK(o.sequencer.ended() == 1);
    o.end(2), o.end(2);
    CHECK(o.sequencer.ended() == 1);
    CHECK(o.sequencer.counts().duplicate == 0);
}

TEST_CASE("Datagrams without a number are taken as they come", "[source.udp]") {
    Ordered o(settings());
    o.push(std::nullopt), o.push(std::nullopt);
    CHECK(o.taken() == Values{0, 0});
    CHECK(o.sequencer.counts().duplicate == 0);
}

TEST_CASE("A gap as wide as numbers go costs nothing", "[source.udp]") {
    Ordered o(settings());
    o.push(0), o.push(std::uint64_t{1} << 62);
    o.sequencer.flush();
    CHECK(o.sequencer.counts().lost == (std::uint64_t{1} << 62) - 1);
    o.push(77);
    CHECK(o.sequencer.counts().late == 1);
}

TEST_CASE("A saved order goes on with what it held", "[source.udp]") {
    Ordered before(settings());
    before.push(0), before.push(2), before.push(5);
    pelorus::StateWriter writer;
    before.sequencer.state(writer);
    Ordered after(settings());
    pelorus::StateReader reader(writer.bytes().data(), writer.bytes().size());
    after.sequencer.state(reader);
    CHECK(reader.left() == 0);
    CHECK(after.sequencer.waiting_bytes() == before.sequencer.waiting_bytes());
    after.push(1, 1'000'000), after.sequencer.expire(1'000'000);
    CHECK(after.taken() == Values{0, 1, 2});
    after.sequencer.expire(1'000'100);
    CHECK(after.taken() == Values{5});
    CHECK(after.sequencer.counts().lost == 2);
}
