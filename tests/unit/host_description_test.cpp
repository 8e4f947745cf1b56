#include "host/description.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <pelorus/abi/message.h>

using namespace pelorus::host;
using Catch::Matchers::Contains;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

plr_parameter parameter(const char* name, std::uint32_t type) {
    plr_parameter made{};
    made.struct_size = sizeof made;
    made.type = type;
    made.name = name;
    made.doc = "doc";
    made.unit = "";
    made.default_text = "0";
    made.min = -infinity;
    made.max = infinity;
    made.rows_max = made.cols_max = -1;
    return made;
}

plr_port port(const char* name) { return {sizeof(plr_port), 0, name, "doc", PLR_MESSAGE_SCAN, 0}; }

/// A tracker with some of everything, and handles to break each.
struct Example {
    const char* words[2] = {"one", "two"};
    double zero = 0;
    std::vector<plr_parameter> columns = {parameter("duration", PLR_TYPE_DOUBLE), parameter("label", PLR_TYPE_STRING)};
    std::vector<plr_parameter> parameters = {parameter("noise", PLR_TYPE_DOUBLE), parameter("form", PLR_TYPE_CHOICE),
                                             parameter("legs", PLR_TYPE_TABLE)};
    std::vector<plr_parameter> of_part = {parameter("period", PLR_TYPE_DOUBLE)};
    std::vector<plr_slot> slots = {{sizeof(plr_slot), 1, -1, 1, "sensors", "sensor", "doc", of_part.data()}};
    std::vector<plr_input> inputs = {{sizeof(plr_input), 1, "bias", "rad", "doc", &zero}};
    std::vector<plr_port> in_ports = {port("scans")}, out_ports = {port("tracks")};
    plr_description description{};

    Example() {
        parameters[1].choices = words;
        parameters[1].choice_count = 2;
        parameters[2].columns = columns.data();
        parameters[2].column_count = 2;
        description.struct_size = sizeof description;
        description.id = "tracker.example";
        description.kind = "tracker";
        description.version = "1.0.0";
        description.title = description.purpose = description.equation = description.source = description.license = "";
        description.parameters = parameters.data();
        description.parameter_count = 3;
        description.slots = slots.data();
        description.slot_count = 1;
        description.inputs = inputs.data();
        description.input_count = 1;
        description.in_ports = in_ports.data();
        description.in_port_count = 1;
        description.out_ports = out_ports.data();
        description.out_port_count = 1;
    }
    std::string problem() const { return description_problem(description); }
};

}  // namespace

TEST_CASE("A sound description has no problem", "[host]") { CHECK(Example().problem().empty()); }

TEST_CASE("Missing strings and arrays of a description are named", "[host]") {
    Example e;
    SECTION("purpose") {
        e.description.purpose = nullptr;
        CHECK(e.problem() == "it has no purpose (NULL)");
    }
    SECTION("array") {
        e.description.slots = nullptr;
        CHECK(e.problem() == "it claims 1 slots but gives none (NULL)");
    }
    SECTION("name") {
        e.parameters[1].name = nullptr;
        CHECK(e.problem() == "parameter 1 has no name");
    }
    SECTION("doc") {
        e.parameters[0].doc = nullptr;
        CHECK(e.problem() == "parameter noise has no doc (NULL)");
    }
    SECTION("unit") {
        e.inputs[0].unit = nullptr;
        CHECK_THAT(e.problem(), Contains("input bias has no unit"));
    }
    SECTION("choices") {
        e.parameters[1].choices = nullptr;
        CHECK(e.problem() == "parameter form is a choice of nothing");
    }
    SECTION("defaults") {
        e.inputs[0].defaults = nullptr;
        CHECK_THAT(e.problem(), Contains("input bias has no size or no defaults"));
    }
    SECTION("columns") {
        e.parameters[2].columns = nullptr;
        CHECK(e.problem() == "it claims 2 columns of parameter legs but gives none (NULL)");
    }
    SECTION("struct size") {
        e.parameters[0].struct_size = 8;
        CHECK_THAT(e.problem(), Contains("parameters: a struct_size of 8 bytes, expected at least"));
    }
}

TEST_CASE("Names that an address cannot tell apart are refused", "[host]") {
    Example e;
    SECTION("two parameters") {
        e.parameters[1].name = "noise";
        CHECK(e.problem() == "parameter noise: its name is taken");
    }
    SECTION("a slot and a parameter") {
        e.slots[0].name = "form";
        CHECK(e.problem() == "slot form: its name is taken");
    }
    SECTION("two columns") {
        e.columns[1].name = "duration";
        CHECK_THAT(e.problem(), Contains("column duration of parameter legs"));
    }
    SECTION("a word of the config") {
        e.parameters[0].name = "use";
        CHECK_THAT(e.problem(), Contains("a word of the config itself"));
    }
    SECTION("a dot") {
        e.parameters[0].name = "noise.x";
        CHECK_THAT(e.problem(), Contains("a name is made of letters"));
    }
    SECTION("the same choice twice") {
        e.words[1] = "one";
        CHECK_THAT(e.problem(), Contains("offers the choice one twice"));
    }
}

TEST_CASE("A parameter needs a default unless it is required or optional", "[host]") {
    Example e;
    e.parameters[0].default_text = nullptr;
    CHECK(e.problem() == "parameter noise has no default, and is neither required nor optional");
    e.parameters[0].flags = PLR_PARAMETER_REQUIRED;
    CHECK(e.problem().empty());
    e.parameters[0].flags = PLR_PARAMETER_OPTIONAL;
    CHECK(e.problem().empty());
    e.parameters[0].flags = PLR_PARAMETER_OPTIONAL | PLR_PARAMETER_REQUIRED;
    CHECK(e.problem() == "parameter noise is both required and optional");
    e.parameters[0].flags = 0;
    e.parameters[0].default_text = "0";
    e.of_part[0].default_text = nullptr;
    CHECK(e.problem() == "parameter period of slot sensors has no default, and is neither required nor optional");
}

TEST_CASE("Bounds, types and kinds that nothing satisfies are refused", "[host]") {
    Example e;
    SECTION("type") {
        e.parameters[0].type = 77;
        CHECK(e.problem() == "parameter noise has the unknown type 77");
    }
    SECTION("bounds") {
        e.parameters[0].min = 2;
        e.parameters[0].max = 1;
        CHECK_THAT(e.problem(), Contains("min and max"));
    }
    SECTION("not a bound") {
        e.parameters[0].min = std::nan("");
        CHECK_THAT(e.problem(), Contains("min and max"));
    }
    SECTION("rows") {
        e.parameters[2].rows_min = 3;
        e.parameters[2].rows_max = 2;
        CHECK_THAT(e.problem(), Contains("rows_min"));
    }
    SECTION("nested table") {
        e.columns[0].type = PLR_TYPE_TABLE;
        CHECK_THAT(e.problem(), Contains("tables do not nest"));
    }
    SECTION("column type") {
        e.columns[0].type = PLR_TYPE_MATRIX;
        CHECK_THAT(e.problem(), Contains("neither bool, int"));
    }
    SECTION("slot kind") {
        e.slots[0].kind = "levitation";
        CHECK_THAT(e.problem(), Contains("unknown kind levitation"));
    }
    SECTION("slot counts") {
        e.slots[0].min = 3;
        e.slots[0].max = 2;
        CHECK_THAT(e.problem(), Contains("holds 3 to 2 parts"));
    }
    SECTION("message") {
        e.in_ports[0].message = 9;
        CHECK_THAT(e.problem(), Contains("in port scans carries messages"));
    }
    SECTION("kind") {
        e.description.kind = "levitation";
        CHECK(e.problem() == "the unknown kind levitation");
    }
    SECTION("ports of a model") {
        e.description.kind = "motion";
        CHECK(e.problem() == "a model has no ports");
    }
}

TEST_CASE("Arrays of a later version are stepped through by their own struct size", "[host]") {
    struct Later {
        plr_port port;
        std::uint64_t what_is_new;
    };
    Later later[2] = {{port("scans"), 1}, {port("scans"), 2}};
    later[0].port.struct_size = later[1].port.struct_size = sizeof(Later);
    Example e;
    e.description.in_ports = &later[0].port;
    e.description.in_port_count = 2;
    CHECK(e.problem() == "in port scans: its name is taken");
    later[1].port.name = "truth";
    CHECK(e.problem().empty());
    CHECK(element(e.description.in_ports, 1).name == std::string("truth"));
}
