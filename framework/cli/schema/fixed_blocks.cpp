#include "cli/schema/fixed_blocks.hpp"

#include <cstdint>
#include <limits>

#include "cli/schema/parameter_schema.hpp"

namespace pelorus::cli {

using Json = nlohmann::ordered_json;

namespace {

Json vector_of(int count, const char* unit, const char* doc) {
    return parameter_schema({{"type", "vector"},
                             {"unit", unit},
                             {"doc", doc},
                             {"required", false},
                             {"default", nullptr},
                             {"rows", {{"min", count}, {"max", count}}}});
}

Json text(const char* doc) { return {{"type", "string"}, {"description", doc}}; }

Json map_of(Json values, const char* doc) {
    return {{"type", "object"}, {"description", doc}, {"additionalProperties", std::move(values)}};
}

Json frame_schema() {
    Json frame{{"type", "object"},
               {"properties",
                {{"origin", vector_of(3, "rad, rad, m", "latitude, longitude and height on WGS84: x is east, z up")},
                 {"parent", text("the frame that this one stands on; the root frame if absent")},
                 {"translation", vector_of(3, "m", "shift in the parent's axes")},
                 {"attitude", vector_of(3, "rad", "roll, pitch, yaw: roll is applied first")},
                 {"quaternion", vector_of(4, "", "w, x, y, z, of norm 1; instead of attitude")}}},
               {"additionalProperties", false}};
    // Either on Earth or on a parent; one way of turning.
    for (const char* key : {"parent", "translation", "attitude", "quaternion"})
        frame["dependencies"]["origin"]["properties"][key] = false;
    frame["dependencies"]["attitude"]["properties"]["quaternion"] = false;
    return frame;
}

}  // namespace

Json name_schema() {
    return {{"pattern", "^(?!(use|like|with|parts|in|frame|run|previous)$)[A-Za-z_][A-Za-z0-9_]*$"},
            {"patternErrorMessage", "a name has letters, digits and _, no digit first, and is no word of the config"}};
}

Json or_nothing(Json schema) { return {{"anyOf", {std::move(schema), {{"type", "null"}}}}}; }

Json run_schema() {
    return {{"type", "object"},
            {"description", "What is asked of every run."},
            {"properties",
             {{"seed",
               {{"type", "integer"},
                {"minimum", 0},
                {"maximum", std::numeric_limits<std::uint64_t>::max()},
                {"default", 0},
                {"description", "seed of all random numbers"}}}}},
            {"additionalProperties", false}};
}

Json frames_schema(bool extends) {
    Json frames = map_of(extends ? or_nothing(frame_schema()) : frame_schema(), "Coordinate frames by name.");
    frames["propertyNames"] = name_schema();
    return extends ? or_nothing(std::move(frames)) : frames;
}

Json campaign_schema(bool extends) {
    const Json values{{"type", "array"}, {"minItems", 1}};
    Json axis{{"type", {"array", "object"}}, {"minItems", 1}, {"minProperties", 1}, {"additionalProperties", values}};
    Json overrides = map_of(true, "Addresses and the values that they get.");
    Json sweep =
        map_of(extends ? or_nothing(std::move(axis)) : std::move(axis),
               "A grid: addresses, each with a list of values; or a name with a map from addresses to lists of "
               "one length, which go together.");
    Json variants = map_of(extends ? or_nothing(std::move(overrides)) : std::move(overrides),
                           "Named sets of overrides: addresses and values; {} for none.");
    Json runs{{"type", "integer"}, {"minimum", 1}, {"description", "runs of each variant and grid point"}};
    Json reference{{"type", "string"},
                   {"description", "the variant that the others are compared with: the first unless given"}};
    Json on_failure{{"enum", {"stop", "continue"}},
                    {"default", "stop"},
                    {"description", "a failed run ends the campaign, or is counted and left out"}};
    const auto may_go = [extends](Json schema) { return extends ? or_nothing(std::move(schema)) : schema; };
    return may_go({{"type", "object"},
                   {"description", "Many runs of one config."},
                   {"properties",
                    {{"runs", may_go(std::move(runs))},
                     {"sweep", may_go(std::move(sweep))},
                     {"variants", may_go(std::move(variants))},
                     {"reference", may_go(std::move(reference))},
                     {"on_failure", may_go(std::move(on_failure))}}},
                   {"additionalProperties", false}});
}

}  // namespace pelorus::cli
