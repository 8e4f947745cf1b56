#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graph_fakes.hpp"

using namespace pelorus;
using fakes::FakePlugin;
using fakes::FakePlugins;

namespace {

/// One stage with the parameters of a test; keeps what create was given.
struct OnePlugin {
    OnePlugin() : plugin(plugins.add("sink.one", "sink")) {
        plugin.on_create = [this](const plr_config& config, plr_error&) {
            values.assign(config.values, config.values + config.value_count);
            return PLR_OK;
        };
    }
    static std::string config(const std::string& with) {
        return "pelorus: 1\ngraph:\n  n:\n    use: sink.one\n    with:\n" + with;
    }
    /// Builds with the lines under `with:`, keeps the graph alive and answers what is wrong.
    std::string read(const std::string& with, const std::vector<graph::Override>& overrides = {}) {
        try {
            graph = std::make_unique<graph::Graph>(
                plugins.build(with.empty() ? config("      {}\n") : config(with), overrides, options));
            return "built";
        } catch (const ConfigError& error) {
            return error.what();
        }
    }

    FakePlugins plugins;
    FakePlugin& plugin;
    std::vector<plr_value> values;
    graph::BuildOptions options;
    std::unique_ptr<graph::Graph> graph;
};

}  // namespace

TEST_CASE("Single values arrive converted and stay as long as the graph", "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("flag", PLR_TYPE_BOOL);
    one.plugin.parameter("count", PLR_TYPE_INT);
    one.plugin.parameter("angle", PLR_TYPE_DOUBLE).unit("rad");
    one.plugin.parameter("label", PLR_TYPE_STRING);
    one.plugin.parameter("form", PLR_TYPE_CHOICE).choices({"exact", "truncated"});
    REQUIRE(
        one.read(
            "      flag: true\n      count: -3\n      angle: 3 mrad\n      label: \"5 m\"\n      form: truncated\n") ==
        "built");
    REQUIRE(one.values.size() == 5);
    for (const plr_value& value : one.values) {
        CHECK(value.present == 1);
        CHECK(value.struct_size == sizeof(plr_value));
    }
    CHECK(one.values[0].integer == 1);
    CHECK(one.values[1].integer == -3);
    CHECK(one.values[2].number == 0.003);
    CHECK(std::string(one.values[3].text) == "5 m");
    CHECK(one.values[4].integer == 1);
    CHECK(std::string(one.values[4].text) == "truncated");
}

TEST_CASE("Defaults are read by the same rules, optional parameters may be absent", "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("rate", PLR_TYPE_DOUBLE).unit("1/s").initially("0.1 1/s");
    one.plugin.parameter("axes", PLR_TYPE_VECTOR).unit("m").initially("[1 m, 2 km]").rows(2, 2);
    one.plugin.parameter("label", PLR_TYPE_STRING).initially("");
    one.plugin.parameter("period", PLR_TYPE_DOUBLE).unit("s").optional();
    one.plugin.parameter("on", PLR_TYPE_BOOL).initially("true");
    REQUIRE(one.read("") == "built");
    CHECK(one.values[0].number == 0.1);
    CHECK(one.values[1].numbers.data[1] == 2000.0);
    CHECK(std::string(one.values[2].text).empty());
    CHECK(one.values[3].present == 0);
    CHECK(std::isnan(one.values[3].number));
    CHECK(one.values[4].integer == 1);
}

TEST_CASE("Values that do not fit are refused at their place, all at once", "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("threshold", PLR_TYPE_DOUBLE).unit("m").above(0).max(5);
    one.plugin.parameter("share", PLR_TYPE_DOUBLE).initially("0.5").min(0).below(1);
    one.plugin.parameter("scans", PLR_TYPE_INT).initially("1").min(1);
    one.plugin.parameter("form", PLR_TYPE_CHOICE).initially("exact").choices({"exact", "truncated"});
    one.plugin.parameter("on", PLR_TYPE_BOOL).initially("true");
    one.plugin.parameter("name", PLR_TYPE_STRING).initially("x");
    CHECK(one.read("      threshold: 3 s\n      share: 1\n      scans: 2.5\n      form: truncatd\n      on: yes\n      "
                   "name: [a]\n") ==
          "test.yaml:6:18: n.threshold: expected a value in m, got '3 s' (s is a time)\n"
          "test.yaml:7:14: n.share: must be at least 0 and less than 1, got '1'\n"
          "test.yaml:8:14: n.scans: expected a whole number, got '2.5'\n"
          "test.yaml:9:13: n.form: expected one of exact, truncated, got 'truncatd'; did you mean 'truncated'?\n"
          "test.yaml:10:11: n.on: expected true or false, got 'yes'\n"
          "test.yaml:11:13: n.name: expected a text, got a list");
    CHECK(one.read("      threshold: 0 m\n") ==
          "test.yaml:6:18: n.threshold: must be greater than 0 m and at most 5 m, got '0 m'");
    CHECK(one.read("      threshold: 6 m\n") ==
          "test.yaml:6:18: n.threshold: must be greater than 0 m and at most 5 m, got '6 m'");
    CHECK(one.read("      {threshold: 1, scans: 0}\n") == "test.yaml:6:29: n.scans: must be at least 1, got '0'");
    CHECK(one.read("      threshold: inf\n") ==
          "test.yaml:6:18: n.threshold: expected a value in m, got 'inf' (values are finite numbers)");
    CHECK(one.read("      threshold: {a: 1}\n") == "test.yaml:6:18: n.threshold: expected a value in m, got a map");
    CHECK(one.read("      threshold:\n") ==
          "test.yaml:6:7: n.threshold: has no value; give one, or leave the key out for the default");
}

TEST_CASE("Unknown and missing parameters are named with what there is", "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("noise", PLR_TYPE_DOUBLE).unit("m").doc("standard deviation of a position");
    one.plugin.parameter("rate", PLR_TYPE_DOUBLE).initially("1");
    CHECK(one.read("      nosie: 1 m\n      colour: red\n") ==
          "test.yaml:6:7: n: sink.one has no parameter 'nosie'; did you mean 'noise'? parameters: noise, rate\n"
          "test.yaml:7:7: n: sink.one has no parameter 'colour'; parameters: noise, rate");
}

TEST_CASE("A whole number may have a unit", "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("window", PLR_TYPE_INT).unit("s");
    REQUIRE(one.read("      window: 2 min\n") == "built");
    CHECK(one.values[0].integer == 120);
    CHECK(one.read("      window: 1500 ms\n") ==
          "test.yaml:6:15: n.window: expected a whole number in s, got '1500 ms'");
}

TEST_CASE("Vectors have a unit an element, and a single value fills them", "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("mount", PLR_TYPE_VECTOR).unit("m, rad, rad").rows(3, 3);
    one.plugin.parameter("axes", PLR_TYPE_VECTOR).unit("m").initially("[]").rows(0, 4);
    REQUIRE(one.read("      mount: [1 km, 180 deg, 0.5]\n      axes: 3 m\n") == "built");
    const plr_const_view& mount = one.values[0].numbers;
    CHECK(mount.rows == 3);
    CHECK(mount.cols == 1);
    CHECK(mount.count == 1);
    CHECK(mount.data[0] == 1000.0);
    CHECK(mount.data[1] == Approx(3.14159265358979));
    CHECK(mount.data[2] == 0.5);
    CHECK(one.values[1].numbers.rows == 1);
    REQUIRE(one.read("      mount: 0\n") == "built");
    CHECK(one.values[0].numbers.rows == 3);
    CHECK(one.values[0].numbers.data[2] == 0.0);
    CHECK(one.values[1].numbers.rows == 0);

    CHECK(one.read("      mount: 1 m\n") == "test.yaml:6:14: n.mount: takes 3 values (m, rad, rad), got one: '1 m'");
    CHECK(one.read("      mount: [1 m, 2 m, 3]\n") ==
          "test.yaml:6:20: n.mount[1]: expected a value in rad, got '2 m' (m is a length)");
    const std::string comma = "' one of them? Decimals stand after a point, not a comma";
    const std::string four = "test.yaml:6:14: n.mount: expected 3 elements, got 4";
    CHECK(one.read("      mount: [25 m, 0,15 deg, 0.2 deg]\n") == four + "; is '0,15 deg" + comma);
    CHECK(one.read("      mount: [25, 0,15, 0.2]\n") == four + "; is '0,15" + comma);
    for (const char* four_elements : {"[1, 2, 3, 4]", "[1,2,3,4]", "[25 m, 0, 15 deg, 0.2]", "[25 m, 1 m, '0',15]"})
        CHECK(one.read(std::string("      mount: ") + four_elements + "\n") == four);
    CHECK(one.read("      mount: 0\n", {{"n.mount", "[25 m, 0,15 deg, 0.2 deg]"}}).find("; is '0,15 deg" + comma) !=
          std::string::npos);
    CHECK(one.read("      mount: [1, 2]\n") == "test.yaml:6:14: n.mount: expected 3 elements, got 2");
    CHECK(one.read("      {mount: 0, axes: [1, 2, 3, 4, 5]}\n") ==
          "test.yaml:6:24: n.axes: expected 0 to 4 elements, got 5");
    CHECK(one.read("      mount: {a: 1}\n") ==
          "test.yaml:6:14: n.mount: expected a list, or one value for all elements, got a map");
}

TEST_CASE("Matrices are lists of rows and lie column by column", "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("gain", PLR_TYPE_MATRIX).unit("m, rad").rows(2, 2).cols(1, 3);
    REQUIRE(one.read("      gain:\n        - [1 km, 2 m, 3 m]\n        - [4, 5 mrad, 6]\n") == "built");
    const plr_const_view& gain = one.values[0].numbers;
    CHECK(gain.rows == 2);
    CHECK(gain.cols == 3);
    CHECK(gain.row_stride == 1);
    CHECK(gain.col_stride == 2);
    CHECK(gain.item_stride == 6);
    CHECK(std::vector<double>(gain.data, gain.data + 6) == std::vector<double>{1000, 4, 2, 0.005, 3, 6});

    CHECK(one.read("      gain: [[1, 2], [3]]\n") == "test.yaml:6:22: n.gain[1]: has 1 columns, the first row has 2");
    CHECK(one.read("      gain: [[1, 2]]\n") == "test.yaml:6:13: n.gain: expected 2 rows, got 1");
    CHECK(one.read("      gain: [[1, 2, 3, 4], [1, 2, 3, 4]]\n") ==
          "test.yaml:6:14: n.gain[0]: expected 1 to 3 columns, got 4");
    CHECK(one.read("      gain: [1, 2]\n") ==
          "test.yaml:6:14: n.gain[0]: expected a list (one row of the matrix), got '1'");
    CHECK(one.read("      gain: [[1 m], [1 m]]\n") ==
          "test.yaml:6:22: n.gain[1][0]: expected a value in rad, got '1 m' (m is a length)");
    CHECK(one.read("      gain: 3\n") == "test.yaml:6:13: n.gain: expected a list of rows, got '3'");
}

namespace {

void add_table(FakePlugin& plugin) {
    auto legs = plugin.parameter("legs", PLR_TYPE_TABLE).rows(1, 3);
    legs.column("duration", PLR_TYPE_DOUBLE).unit("s").above(0);
    legs.column("turn_rate", PLR_TYPE_DOUBLE).unit("rad/s").initially("0 deg/s");
    legs.column("bank", PLR_TYPE_DOUBLE).unit("rad").optional();
    legs.column("mode", PLR_TYPE_CHOICE).initially("level").choices({"climb", "level"});
    legs.column("note", PLR_TYPE_STRING).optional();
    legs.column("last", PLR_TYPE_BOOL).initially("false");
}

}  // namespace

TEST_CASE("Tables are lists of maps, and absent cells have defaults, NaN or no text", "[graph][parameters]") {
    OnePlugin one;
    add_table(one.plugin);
    REQUIRE(one.read("      legs:\n        - {duration: 2 min, mode: climb, note: up, bank: 10 deg}\n"
                     "        - {duration: 30 s, turn_rate: 90 deg/s, last: true}\n") == "built");
    const plr_value& legs = one.values[0];
    REQUIRE(legs.numbers.rows == 2);
    REQUIRE(legs.numbers.cols == 6);
    const auto number = [&](int row, int column) { return legs.numbers.data[column * legs.numbers.col_stride + row]; };
    const auto text = [&](int row, int column) { return legs.texts[row * 6 + column]; };
    CHECK(number(0, 0) == 120.0);
    CHECK(number(1, 0) == 30.0);
    CHECK(number(0, 1) == 0.0);
    CHECK(number(1, 1) == Approx(1.5707963267948966));
    CHECK(number(0, 2) == Approx(0.17453292519943295));
    CHECK(std::isnan(number(1, 2)));
    CHECK(number(0, 3) == 0.0);
    CHECK(number(1, 3) == 1.0);
    CHECK(number(1, 5) == 1.0);
    CHECK(text(0, 0) == nullptr);
    CHECK(std::string(text(1, 3)) == "level");
    CHECK(std::string(text(0, 4)) == "up");
    CHECK(text(1, 4) == nullptr);
}

TEST_CASE("A row of a table may be a list of values in the order of the columns", "[graph][parameters]") {
    OnePlugin one;
    add_table(one.plugin);
    REQUIRE(one.read("      legs: [[2 min, 90 deg/s, 10 deg, climb], {duration: 30 s}, [5]]\n") == "built");
    const plr_value& legs = one.values[0];
    REQUIRE(legs.numbers.rows == 3);
    const auto number = [&](int row, int column) { return legs.numbers.data[column * legs.numbers.col_stride + row]; };
    CHECK(number(0, 0) == 120.0);
    CHECK(number(0, 1) == Approx(1.5707963267948966));
    CHECK(std::string(legs.texts[3]) == "climb");
    CHECK(number(1, 0) == 30.0);
    CHECK(number(2, 0) == 5.0);
    CHECK(number(2, 1) == 0.0);
    CHECK(std::isnan(number(2, 2)));
}

TEST_CASE("What is wrong in a table is named by row and column", "[graph][parameters]") {
    OnePlugin one;
    add_table(one.plugin);
    CHECK(one.read("      legs: [{duration: 1 s}, {turn_rate: 1}]\n") ==
          "test.yaml:6:31: n.legs[1]: column 'duration' is required");
    CHECK(one.read("      legs: [{duration: 0 s}]\n") ==
          "test.yaml:6:25: n.legs[0].duration: must be greater than 0 s, got '0 s'");
    CHECK(one.read("      legs: [{duration: 1 s, turnrate: 1}]\n") ==
          "test.yaml:6:30: n.legs[0]: there is no column 'turnrate'; did you mean 'turn_rate'? columns: duration, "
          "turn_rate, bank, "
          "mode, note, last");
    CHECK(one.read("      legs: []\n") == "test.yaml:6:13: n.legs: expected 1 to 3 rows, got 0");
    CHECK(one.read("      legs: {duration: 1 s}\n") ==
          "test.yaml:6:13: n.legs: expected a list of rows (maps from column to value, or lists of values), got a map");
    CHECK(one.read("      legs: [5]\n") ==
          "test.yaml:6:14: n.legs[0]: expected a map from column to value, or a list of values, got '5'");
    CHECK(one.read("      legs: [[1 s, 2, 3, climb, up, true, 7]]\n") ==
          "test.yaml:6:43: n.legs[0]: has 7 values, columns are duration, turn_rate, bank, mode, note, last");
    CHECK(one.read("      legs: [[]]\n") == "test.yaml:6:14: n.legs[0]: column 'duration' is required");
    CHECK(one.read("      legs: [[1 s, 2 s]]\n") ==
          "test.yaml:6:20: n.legs[0].turn_rate: expected a value in rad/s, got '2 s' (s is a time)");
    CHECK(one.read("      legs: [{duration: 1 s, mode: lvl}]\n") ==
          "test.yaml:6:36: n.legs[0].mode: expected one of climb, level, got 'lvl'");
}

TEST_CASE("Paths expand variables and are relative to their file, on the command line to the working directory",
          "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("file", PLR_TYPE_PATH).initially("${PELORUS_TEST_OUT}/tracks.csv");
    ::unsetenv("PELORUS_TEST_NOWHERE");
    ::setenv("PELORUS_TEST_DATA", "/data", 1);
    one.options.variables["PELORUS_TEST_OUT"] = "/out";
    const auto path = [&] { return std::string(one.values[0].text); };
    REQUIRE(one.read("      file: a/../b.csv\n") == "built");
    CHECK(path() == "/configs/b.csv");
    REQUIRE(one.read("      file: ${PELORUS_TEST_DATA}/c.csv\n") == "built");
    CHECK(path() == "/data/c.csv");
    REQUIRE(one.read("") == "built");
    CHECK(path() == "/out/tracks.csv");
    REQUIRE(one.read("", {{"n.file", "d.csv"}}) == "built");
    CHECK(path() == (std::filesystem::current_path() / "d.csv").string());

    CHECK(one.read("      file: ${PELORUS_TEST_NOWHERE}/c.csv\n") ==
          "test.yaml:6:13: n.file: environment variable PELORUS_TEST_NOWHERE is not set");
    CHECK(one.read("      file: ${PELORUS_TEST_DATA\n") ==
          "test.yaml:6:13: n.file: '${' without '}' in '${PELORUS_TEST_DATA'");
    CHECK(one.read("      file: ''\n") == "test.yaml:6:13: n.file: expected a path, got ''");
    one.options.variables.clear();
    CHECK(one.read("") == "test.yaml:4:10: n.file: environment variable PELORUS_TEST_OUT is not set");
}

TEST_CASE("A plugin whose defaults or units make no sense is named", "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("rate", PLR_TYPE_DOUBLE).unit("1/s").initially("3 m");
    one.plugin.parameter("list", PLR_TYPE_VECTOR).initially("[1, 2").rows(2, 2);
    one.plugin.parameter("size", PLR_TYPE_DOUBLE).unit("furlong").initially("1");
    one.plugin.parameter("angle", PLR_TYPE_DOUBLE).unit("deg").initially("1");
    one.plugin.parameter("pose", PLR_TYPE_VECTOR).unit("m, rad").initially("0").rows(3, 3);
    CHECK(one.read("") ==
          "test.yaml:4:10: plugin sink.one declares a default that does not fit: rate: expected a value in 1/s, got '3 "
          "m' (m is a "
          "length)\n"
          "test.yaml:4:10: plugin sink.one declares a default that does not fit: list: this is not YAML: this '[' "
          "is not closed\n"
          "test.yaml:4:10: plugin sink.one declares a default that does not fit: size: the plugin declares a wrong "
          "unit: there is no "
          "unit 'furlong'\n"
          "test.yaml:4:10: plugin sink.one declares a default that does not fit: angle: the plugin declares a wrong "
          "unit: 'deg' is "
          "not an SI unit\n"
          "test.yaml:4:10: plugin sink.one declares a default that does not fit: pose: the plugin declares units for 2 "
          "elements, "
          "there are 3");
}

TEST_CASE("The resolved values are those that were created from, in SI", "[graph][parameters]") {
    OnePlugin one;
    one.plugin.parameter("angle", PLR_TYPE_DOUBLE).unit("rad");
    one.plugin.parameter("gain", PLR_TYPE_MATRIX).initially("[[1, 2], [3, 4]]");
    one.plugin.parameter("axes", PLR_TYPE_VECTOR).unit("m").rows(3, 3).initially("1 km");
    one.plugin.parameter("period", PLR_TYPE_DOUBLE).optional();
    one.plugin.parameter("seed", PLR_TYPE_INT).initially("9007199254740993");
    add_table(one.plugin);
    REQUIRE(one.read("      angle: 3 mrad\n      legs: [{duration: 1 min, note: n}]\n") == "built");
    CHECK(one.graph->resolved()["graph"]["n"]["with"].dump() ==
          R"({"angle":0.003,"gain":[[1.0,2.0],[3.0,4.0]],"axes":[1000.0,1000.0,1000.0],"seed":9007199254740993,)"
          R"("legs":[{"duration":60.0,"turn_rate":0.0,"mode":"level","note":"n","last":false}]})");
}
