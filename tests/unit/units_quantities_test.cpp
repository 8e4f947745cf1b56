#include <catch2/catch.hpp>

#include <cmath>

#include "graph/units.hpp"

using namespace pelorus::graph;
using Catch::Matchers::Message;

namespace {
constexpr double pi = 3.14159265358979323846;
}

TEST_CASE("A quantity is converted to SI and equals the number that one would have written there", "[units]") {
    CHECK(parse_quantity("3 mrad", "rad") == 0.003);
    CHECK(parse_quantity("25 km", "m") == 25000.0);
    CHECK(parse_quantity("0.1 1/s", "1/s") == 0.1);
    CHECK(parse_quantity("0.1 m/s2", "m/s2") == 0.1);
    CHECK(parse_quantity("0.1 m/s^2", "m/s2") == 0.1);
    CHECK(parse_quantity("0.1 m/s/s", "m/s2") == 0.1);
    CHECK(parse_quantity("0.1 m*s-2", "m/s2") == 0.1);
    CHECK(parse_quantity("0.1 m s^-2", "m/s2") == 0.1);
    CHECK(parse_quantity("0.1 m/s\xC2\xB2", "m/s2") == 0.1);
    CHECK(parse_quantity("1e-3 m2/s3", "m2/s3") == 0.001);
    CHECK(parse_quantity("37.5 deg", "rad") == Approx(37.5 * pi / 180).epsilon(1e-15));
    CHECK(parse_quantity("45\xC2\xB0", "rad") == pi / 4);
    CHECK(parse_quantity("2 deg/s", "rad/s") == Approx(2 * pi / 180).epsilon(1e-15));
    CHECK(parse_quantity("10 kn", "m/s") == Approx(18520.0 / 3600).epsilon(1e-15));
    CHECK(parse_quantity("36 km/h", "m/s") == 10.0);
    CHECK(parse_quantity("5 nmi", "m") == 9260.0);
    CHECK(parse_quantity("12 ft", "m") == Approx(3.6576).epsilon(1e-15));
    CHECK(parse_quantity("20 dB", "") == Approx(100).epsilon(1e-15));
    CHECK(parse_quantity("-3 dB", "") == Approx(0.501187233627272).epsilon(1e-14));
    CHECK(parse_quantity("5 %", "") == 0.05);
    CHECK(parse_quantity("5%", "") == 0.05);
    CHECK(parse_quantity("100 ms", "s") == 0.1);
    CHECK(parse_quantity("2 min", "s") == 120.0);
    CHECK(parse_quantity("1 h", "s") == 3600.0);
    CHECK(parse_quantity("1 Hz", "1/s") == 1.0);
    CHECK(parse_quantity("24 GHz", "Hz") == 24e9);
    CHECK(parse_quantity("10 urad", "rad") == 1e-5);
    CHECK(parse_quantity("10 \xC2\xB5rad", "rad") == 1e-5);
    CHECK(parse_quantity("10 \xCE\xBCrad", "rad") == 1e-5);
    CHECK(parse_quantity("30 rpm", "rad/s") == Approx(pi).epsilon(1e-15));
    CHECK(parse_quantity("1 kg", "kg") == 1.0);
    CHECK(parse_quantity("2 kW", "kg m2/s3") == 2000.0);
    CHECK(parse_quantity("3 km2", "m2") == 3e6);
    CHECK(parse_quantity("20 m/s", "m/s") == 20.0);
}

TEST_CASE("A number without a unit is taken as it stands, in SI", "[units]") {
    CHECK(parse_quantity("3", "rad") == 3.0);
    CHECK(parse_quantity("-0.5e-2", "m") == -0.005);
    CHECK(parse_quantity("+7.", "") == 7.0);
    CHECK(parse_quantity(".25", "m") == 0.25);
    CHECK(parse_quantity(" 8 ", "m") == 8.0);
}

TEST_CASE("A wrong dimension is refused with what it is", "[units]") {
    CHECK_THROWS_MATCHES(parse_quantity("3 s", "m"), UnitError,
                         Message("expected a value in m, got '3 s' (s is a time)"));
    CHECK_THROWS_MATCHES(parse_quantity("3 m", ""), UnitError,
                         Message("expected a pure number, got '3 m' (m is a length)"));
    CHECK_THROWS_MATCHES(parse_quantity("3 deg", ""), UnitError,
                         Message("expected a pure number, got '3 deg' (deg is an angle)"));
    CHECK_THROWS_MATCHES(parse_quantity("3 1/s", "rad/s"), UnitError,
                         Message("expected a value in rad/s, got '3 1/s' (1/s is a frequency)"));
    CHECK_THROWS_MATCHES(parse_quantity("5 %", "m"), UnitError,
                         Message("expected a value in m, got '5 %' (% is a pure number)"));
    CHECK_THROWS_MATCHES(parse_quantity("1 m2/s3", "m"), UnitError, Message("expected a value in m, got '1 m2/s3'"));
}

TEST_CASE("What is not a quantity is refused", "[units]") {
    CHECK_THROWS_MATCHES(parse_quantity("fast", "m/s"), UnitError,
                         Message("expected a value in m/s, got 'fast' (it does not begin with a number)"));
    CHECK_THROWS_MATCHES(parse_quantity("", "m"), UnitError, Message("expected a value in m, got '' (it is empty)"));
    CHECK_THROWS_MATCHES(
        parse_quantity("3 metres", "m"), UnitError,
        Message("expected a value in m, got '3 metres' (there is no unit 'metres'; there are m, km, ft, nmi)"));
    CHECK_THROWS_MATCHES(
        parse_quantity("50 kph", "m/s"), UnitError,
        Message("expected a value in m/s, got '50 kph' (there is no unit 'kph'; there are m/s, km/h, kn)"));
    CHECK_THROWS_MATCHES(parse_quantity("5 sones", "kg"), UnitError,
                         Message("expected a value in kg, got '5 sones' (there is no unit 'sones')"));
    CHECK_THROWS_MATCHES(parse_quantity("3 mi", "s"), UnitError,
                         Message("expected a value in s, got '3 mi' (there is no unit 'mi'; did you mean 'min'?)"));
    for (const char* text : {"nan",    "inf",     "-inf",   ".nan",   ".inf", "0x10", "1_000", "1,5",  "1e999",
                             "-1e999", "3 m/",    "3 /",    "3 m**2", "3 m^", "3 m0", "3 m22", "3 1",  "3 m 4",
                             "3 dB/s", "3 dB dB", "3 1/dB", "3 dB2",  "1e",   "e5",   "3 m)",  "3 m^-"})
        CHECK_THROWS_AS(parse_quantity(text, "m"), UnitError);
}

TEST_CASE("Numbers and whole numbers are read to the end", "[units]") {
    CHECK(parse_number("1e-3") == 0.001);
    CHECK_THROWS_MATCHES(parse_number("3 m"), UnitError, Message("expected a number, got '3 m'"));
    CHECK(parse_integer("-42") == -42);
    CHECK(parse_integer("+9223372036854775807") == INT64_MAX);
    CHECK_THROWS_MATCHES(parse_integer("3.5"), UnitError, Message("expected a whole number, got '3.5'"));
    CHECK_THROWS_MATCHES(parse_integer("9223372036854775808"), UnitError,
                         Message("'9223372036854775808' does not fit into 64 bits"));
    for (const char* text : {"", "-", "1e3", "0x1F", "1_0", "seven", "+-1"})
        CHECK_THROWS_AS(parse_integer(text), UnitError);
}

TEST_CASE("A time is read to the nanosecond", "[units]") {
    CHECK(parse_time("30 s") == 30'000'000'000);
    CHECK(parse_time("2 min") == 120'000'000'000);
    CHECK(parse_time("1.5") == 1'500'000'000);
    CHECK(parse_time("100 ms") == 100'000'000);
    CHECK(parse_time("0.3 ns") == 0);
    CHECK(parse_time("0.7 ns") == 1);
    CHECK(parse_time("-2 us") == -2000);
    CHECK_THROWS_MATCHES(parse_time("3 m"), UnitError, Message("expected a value in s, got '3 m' (m is a length)"));
    CHECK_THROWS_AS(parse_time("1e12 s"), UnitError);
}

TEST_CASE("A unit knows whether it is SI", "[units]") {
    for (const char* text : {"", "m", "m/s2", "rad", "1/s", "Hz", "kg", "m2/s3"}) CHECK(parse_unit(text).is_si());
    for (const char* text : {"km", "deg", "%", "g", "min", "dB", "km/h"}) CHECK_FALSE(parse_unit(text).is_si());
}
