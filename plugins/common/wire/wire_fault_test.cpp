// Datagrams that are wrong, and what is said of them.
#include <catch2/catch.hpp>

#include "decode.hpp"

namespace {

std::string problem_of(const std::string& bytes) {
    wire::Vocabulary all;
    all.sensors["radar"] = {pelorus::Space({{"range", "m"}, {"azimuth", "rad", 0, 0, true}}), pelorus::Space()};
    all.truth = pelorus::position_space(2);
    wire::Datagram datagram;
    try {
        wire::decode(bytes, all, datagram);
    } catch (const wire::BadFrame& bad) {
        CHECK(datagram.frames.empty());
        const std::string text = bad.what();
        for (const char c : text) CHECK((c >= ' ' && c <= '~'));
        return text;
    }
    return "good";
}

/// A scan with further keys, or with others instead of its own.
std::string scan(const std::string& more, const std::string& measurements = "[[1, 2]]") {
    return "{\"pelorus\":1,\"kind\":\"scan\",\"time_ns\":5,\"sensor\":\"radar\",\"measurements\":" + measurements +
           more + "}";
}

}  // namespace

TEST_CASE("A broken JSON frame is told by line, key and what was expected", "[wire]") {
    CHECK(problem_of(scan("")) == "good");
    const std::vector<std::pair<std::string, std::string>> cases{
        {"", "is empty, expected JSON lines or CSV"},
        {"{", "line 1: is no JSON: parse error"},
        {"{\"pelorus\":1} {}", "line 1: is no JSON"},
        {scan(",\"x-a\":\"\xff\""), "line 1: is no JSON: "},
        {scan(",\"time_ns\":6"), "line 1: has the key 'time_ns' twice"},
        {scan(",\"x-a\":[[[[[[[1]]]]]]]"), "line 1: is nested too deep"},
        {"{\"kind\":\"scan\"}", "line 1: pelorus is missing"},
        {"{\"pelorus\":2}", "line 1: pelorus is 2, this reader knows version 1"},
        {"{\"pelorus\":1,\"kind\":\"scam\"}", "line 1: kind is 'scam', expected scan, truth, tracks or end"},
        {"{\"pelorus\":1,\"kind\":\"scan\"}", "line 1: time_ns (or time, in seconds) is missing"},
        {"{\"pelorus\":1,\"kind\":\"scan\",\"time\":\"1\"}", "line 1: time is no number"},
        {"{\"pelorus\":1,\"kind\":\"scan\",\"time\":1e12}", "line 1: time is beyond what nanoseconds can count"},
        {"{\"pelorus\":1,\"kind\":\"scan\",\"time_ns\":1.5}", "line 1: time_ns is no whole number of nanoseconds"},
        {"{\"pelorus\":1,\"kind\":\"scan\",\"time_ns\":18446744073709551615}", "line 1: time_ns is no whole number"},
        {"{\"pelorus\":1,\"kind\":\"scan\",\"time_ns\":-9223372036854775808}", "line 1: time_ns is no whole number"},
        {scan(",\"time\":5"), "line 1: time_ns and time are both given"},
        {"{\"pelorus\":1,\"kind\":\"scan\",\"time\":1,\"sensor\":\"rader\"}",
         "line 1: sensor 'rader' is none of those in slot sensors: radar"},
        {scan("", "[[1,2],[3]]"), "line 1: measurements[1] is no list of 2 numbers: range [m], azimuth [rad]"},
        {scan("", "[[1,\"x\"]]"), "line 1: measurements[0][1] is no number"},
        {scan("", "[[1,NaN]]"), "line 1: is no JSON"},
        {scan("", "[[1,1e999]]"), "line 1: is no JSON: number overflow"},
        {scan(",\"ids\":[1,2]"), "line 1: ids has 2 entries, expected 1"},
        {scan(",\"ids\":[-1]"), "line 1: ids[0] is no whole number from 0 to 2^64 - 1"},
        {scan(",\"ids\":[18446744073709551616]"), "line 1: ids[0] is no whole number"},
        {scan(",\"covariance\":[[1,2],[3,4]]"), "line 1: covariance is not symmetric"},
        {scan(",\"covariances\":[[[1,2],[2,1]]]"), "line 1: covariances[0] is not positive definite"},
        {scan(",\"covarience\":[[1,0],[0,1]]"), "line 1: key 'covarience' is unknown (keys of your own begin with x-)"},
        {scan(",\"components\":[\"azimuth\",\"range\"]"),
         "line 1: components are [\"azimuth\",\"range\"], expected range [m], azimuth [rad]"},
        {scan(",\"waveform\":[1]"), "line 1: waveform is given, but sensor radar has none"},
        {scan(",\"frame\":\"ship\""), "line 1: frame is 'ship', expected ''"},
        {scan(",\"part\":[1,2]"), "line 1: has a part, but no sequence to order it by"},
        {scan(",\"sequence\":0,\"part\":[3,2]"), "line 1: part is 3 of 2, expected 1 to n, and n at most 10000"},
        {scan(",\"sequence\":9223372036854775807"), "line 1: sequence is beyond 2^62"},
        {scan(",\"sender\":\"a\\n\""), "line 1: sender is not 1 to 64 printable ASCII characters"},
        {scan("") + "\n" + scan(",\"sequence\":4"),
         "line 2: sender, session and sequence are not those of the datagram's first line"},
        {"{\"pelorus\":1,\"kind\":\"truth\",\"time\":1,\"states\":[[1,2]]}", "line 1: ids are missing"},
        {"{\"pelorus\":1,\"kind\":\"truth\",\"time\":1,\"ids\":[1],\"states\":[[1,2]],\"extents\":[[[1,2],[3]]]}",
         "line 1: extents[0][1] is no list of 2 numbers"},
    };
    for (const auto& [bytes, expected] : cases) {
        INFO(bytes);
        CHECK_THAT(problem_of(bytes), Catch::StartsWith(expected));
    }
}

TEST_CASE("A broken CSV frame is told by line, column and what was expected", "[wire]") {
    const std::string head = "pelorus,time,sensor,range,azimuth\n";
    CHECK(problem_of(head + "1,0,radar,1,2\n") == "good");
    CHECK(problem_of("pelorus,kind,range,azimuth\n1,end,,\n") == "good");
    const std::vector<std::pair<std::string, std::string>> cases{
        {"hello", "line 1: begins with neither { nor the column pelorus, but with 'hello'"},
        {"pelorus,pelorus\n1,1\n", "line 1: has the column 'pelorus' twice"},
        {head, "has a header and no row"},
        {head + "1,0,radar,1\n", "line 2: has 4 fields, expected 5"},
        {head + "2,0,radar,1,2\n", "line 2: pelorus is 2, this reader knows version 1"},
        {head + "1,,radar,1,2\n", "line 2: time_ns (or time, in seconds) is missing"},
        {head + "1,now,radar,1,2\n", "line 2: time is 'now', expected a number"},
        {head + "1,0,radar,1,nan\n", "line 2: azimuth is 'nan', expected a number"},
        {head + "1,0,radar,1,1e999\n", "line 2: azimuth is '1e999', expected a number"},
        {head + "1,0,radar,1,\n", "line 2: azimuth is '', expected a number"},
        {head + "1,0,radar,1,2\n1,0,sonar,1,2\n", "line 3: sensor 'sonar' is none of those in slot sensors: radar"},
        {head + "1,0,\"radar,1,2\n", "line 2: has a quote that is not closed"},
        {head + "1,0,\"radar\"x,1,2\n", "line 2: has text behind a closing quote"},
        {"pelorus,time,sensor,range,azimuth,rnage\n1,0,radar,1,2,3\n", "column 'rnage' is unknown"},
        {"pelorus,kind,time,sensor,range,azimuth,rnage\n1,end,,,,,\n1,scan,0,radar,1,2,3\n",
         "column 'rnage' is unknown"},
        {"pelorus,time,sensor,range,azimuth,id\n1,0,radar,1,2,3\n1,0,radar,1,2,\n",
         "line 3: id, measured, snr and covariance must be given for all measurements of a scan or for none"},
        {"pelorus,time,sensor,range,azimuth,deviation.range\n1,0,radar,1,2,3\n",
         "line 2: has a part of its covariance, expected all deviations or the whole upper triangle"},
        {"pelorus,kind\n1,truth\n", "line 2: kind is 'truth', expected scan or end"},
        {"pelorus,time,sensor,sequence,range,azimuth\n1,0,radar,1,1,1\n1,0,radar,2,1,1\n",
         "line 3: sender, session and sequence are not those of the datagram's first line"},
    };
    for (const auto& [bytes, expected] : cases) {
        INFO(bytes);
        CHECK_THAT(problem_of(bytes), Catch::StartsWith(expected));
    }
}

TEST_CASE("A broken frame still tells whose it is and which", "[wire]") {
    wire::Vocabulary all;
    all.sensors["radar"] = {pelorus::position_space(1), pelorus::Space()};
    wire::Datagram datagram;
    CHECK_THROWS_AS(wire::decode("{\"pelorus\":1,\"sender\":\"mast\",\"session\":3,\"sequence\":9,\"kind\":\"scan\"}",
                                 all, datagram),
                    wire::BadFrame);
    CHECK(datagram.sender == "mast");
    CHECK(datagram.session == 3);
    CHECK(datagram.sequence == 9);
}

TEST_CASE("Tracks, and truth that is not wanted, are not read beyond their envelope", "[wire]") {
    wire::Vocabulary all;
    wire::Datagram datagram;
    for (const std::string kind : {"tracks", "truth"}) {
        wire::decode("{\"pelorus\":1,\"kind\":\"" + kind + "\",\"anything\":[1]}", all, datagram);
        REQUIRE(datagram.frames.size() == 1);
        CHECK(datagram.frames[0].rows() == 0);
    }
}

TEST_CASE("A datagram of a hundred thousand brackets costs its size and no more", "[wire]") {
    CHECK(problem_of("{\"a\":" + std::string(65000, '[')) == "line 1: is nested too deep");
    CHECK(problem_of(std::string(65000, '{')).substr(0, 7) == "line 1:");
    CHECK_THAT(problem_of("{" + std::string(65507, ' ')), Catch::Contains("has 65508 bytes, expected at most 65507"));
}
