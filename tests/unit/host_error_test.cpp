#include <catch2/catch.hpp>

#include "host/error.hpp"
#include "host/plugin_error.hpp"

using namespace pelorus;

TEST_CASE("A location prints what is known of it", "[host]") {
    CHECK(Location{"a.yaml", 3, 7}.text() == "a.yaml:3:7");
    CHECK(Location{"a.yaml", 3, 0}.text() == "a.yaml:3");
    CHECK(Location{"--set world.period=1", 0, 0}.text() == "--set world.period=1");
    CHECK(Location{}.text().empty());
}

TEST_CASE("A config error is misuse and prints one line an item", "[host]") {
    std::vector<ConfigError::Item> items(2);
    items[0] = {Location{"a.yaml", 3, 7}, "unknown key rnage"};
    items[1].text = "no graph";
    const ConfigError error(items);
    CHECK(error.exit() == Exit::misuse);
    CHECK(std::string(error.what()) == "a.yaml:3:7: unknown key rnage\nno graph");
    CHECK(error.items().size() == 2);
}

TEST_CASE("A misspelt word finds its nearest neighbour", "[host]") {
    const std::vector<std::string> words = {"range", "azimuth", "maneuver_rate", "use", "in"};
    CHECK(nearest("rnage", words) == "range");  // a swap is one step, so that short words are found too
    CHECK(nearest("rang", words) == "range");
    CHECK(nearest("azimut", words) == "azimuth");
    CHECK(nearest("manoeuver_rate", words) == "maneuver_rate");
    CHECK(nearest("uses", words) == "use");
    CHECK(nearest("elevation", words).empty());
    CHECK(nearest("x", words).empty());
    CHECK(nearest("", words).empty());
    CHECK(nearest("range", {}).empty());
    CHECK(nearest("abcd", {"abce", "abcf"}) == "abce");  // of equals the first
    CHECK(nearest("sensor.positoin", {"sensor.position", "motion.position"}) == "sensor.position");
}

TEST_CASE("Only the first error of a call is kept, and cut to what fits", "[host]") {
    plr_error error = host::empty_error();
    CHECK(host::tell(&error, PLR_E_DATA, "first", "port") == PLR_E_DATA);
    CHECK(host::tell(&error, PLR_E_IO, "second") == PLR_E_IO);
    CHECK(error.code == PLR_E_DATA);
    CHECK(host::error_text(PLR_E_DATA, error) == "port: first");
    CHECK(host::tell(nullptr, PLR_E_IO, "nobody listens") == PLR_E_IO);

    plr_error full = host::empty_error();
    std::string text(510, 'a');
    text += "\xC3\xA9 and more";  // an e acute whose second byte would be the 512th
    host::tell(&full, PLR_E_DATA, text);
    CHECK(std::string(full.message) == std::string(510, 'a'));
}

TEST_CASE("An error that tells nothing is named by its status, one of several lines becomes one", "[host]") {
    plr_error error = host::empty_error();
    CHECK(host::error_text(PLR_E_NUMERIC, error) == "it answered PLR_E_NUMERIC and told no reason");
    CHECK(host::error_text(-99, error) == "it answered status -99 and told no reason");
    host::tell(&error, PLR_E_DATA, "two\nlines\x1b[31m");
    CHECK(host::error_text(PLR_E_DATA, error) == "two lines [31m");
    for (char& character : error.message) character = 'x';  // not terminated, against the contract
    CHECK(host::error_text(PLR_E_DATA, error) == std::string(sizeof error.message, 'x'));
}

TEST_CASE("Exceptions from a guarded call become a status with their text", "[host]") {
    plr_error error = host::empty_error();
    CHECK(host::guarded(error, []() -> plr_status { throw std::runtime_error("no luck"); }) == PLR_E_EXCEPTION);
    CHECK(host::error_text(PLR_E_EXCEPTION, error) == "no luck");
    error = host::empty_error();
    CHECK(host::guarded(error, []() -> plr_status { throw 42; }) == PLR_E_EXCEPTION);
    CHECK(error.code == PLR_E_EXCEPTION);
    error = host::empty_error();
    CHECK(host::guarded(error, [] { return PLR_E_NUMERIC; }) == PLR_E_NUMERIC);
    CHECK(error.code == PLR_E_NUMERIC);
}
