#include "time_text.hpp"

#include <catch2/catch.hpp>
#include <pelorus/failure.hpp>

using source_csv::parse_time;
using source_csv::TimeFormat;

namespace {
constexpr std::int64_t second = 1'000'000'000;
std::int64_t iso(const std::string& text) { return parse_time(text, TimeFormat::iso8601); }
}  // namespace

TEST_CASE("Times in ISO 8601 are nanoseconds since 1970, UTC", "[source.csv]") {
    CHECK(iso("1970-01-01 00:00:00") == 0);
    CHECK(iso("2016-01-12 13:02:11.218") == 1452603731218000000);  // date -u -d '2016-01-12 13:02:11' +%s
    CHECK(iso("2016-01-12T13:02:11.218Z") == iso("2016-01-12 13:02:11,218"));
    CHECK(iso("2016-01-12T15:02:11+02:00") == iso("2016-01-12T13:02:11Z"));
    CHECK(iso("2016-01-12T07:32:11-0530") == iso("2016-01-12T13:02:11Z"));
    CHECK(iso("2016-01-12T15:02+02") == iso("2016-01-12 13:02"));
    CHECK(iso("20160112T130211Z") == iso("2016-01-12 13:02:11"));
    CHECK(iso("2016-01-12") == iso("2016-01-12 00:00"));
    CHECK(iso("2016-01-12T24:00") == iso("2016-01-13T00:00"));
    CHECK(iso("2000-02-29 00:00") == 951782400 * second);
    CHECK(iso("1969-12-31 23:59:59.5") == -second / 2);
    CHECK(iso("2016-12-31 23:59:60") == iso("2017-01-01 00:00:00"));
    CHECK(iso("2016-01-12 13:02:11.1234567894") == iso("2016-01-12 13:02:11") + 123456789);
    CHECK(iso("2016-01-12 13:02:11.9999999996") == iso("2016-01-12 13:02:12"));
}

TEST_CASE("Times in numbers are exact to the nanosecond, whatever their unit", "[source.csv]") {
    CHECK(parse_time("1452603731.218", TimeFormat::seconds) == 1452603731218000000);
    CHECK(parse_time("0.1", TimeFormat::seconds) == 100000000);
    CHECK(parse_time("-0.000000001", TimeFormat::seconds) == -1);
    CHECK(parse_time("+3", TimeFormat::seconds) == 3 * second);
    CHECK(parse_time("7.", TimeFormat::seconds) == 7 * second);
    CHECK(parse_time("1452603731218.25", TimeFormat::milliseconds) == 1452603731218250000);
    CHECK(parse_time("1452603731218250.1234", TimeFormat::microseconds) == 1452603731218250123);
    CHECK(parse_time("1452603731218000001", TimeFormat::nanoseconds) == 1452603731218000001);
    CHECK(parse_time("2.5", TimeFormat::nanoseconds) == 3);
    CHECK(parse_time("1.5e3", TimeFormat::seconds) == 1500 * second);
}

TEST_CASE("Times that are none are refused with what was expected", "[source.csv]") {
    for (const char* text :
         {"", "13:02:11", "2016-13-01", "2016-02-30", "2015-02-29", "2016-01-12 25:00", "2016-01-12 10",
          "2016-01-12 10:61", "2016-1-2", "2016-01-12 13:02:11 UTC", "2016-01-12T13:02:11.Z",
          "2016-01-12 13:02:11+25:00", "0000-01-01", "3000-01-01", "1452603731"}) {
        INFO(text);
        CHECK_THROWS_AS(iso(text), pelorus::DataError);
    }
    for (const char* text :
         {"", "-", "abc", "1,5", "1 2", "nan", "inf", "0x10", "1e30", "99999999999999999999", "--1"}) {
        INFO(text);
        CHECK_THROWS_AS(parse_time(text, TimeFormat::seconds), pelorus::DataError);
    }
    CHECK_THROWS_WITH(parse_time("noon", TimeFormat::seconds), "'noon' is no time: expected a number");
}
