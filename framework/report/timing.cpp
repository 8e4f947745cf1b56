#include "report/timing.hpp"

namespace pelorus::report {

Timings timings_of(const graph::Graph& graph, const runtime::Runtime& runtime, double total_seconds) {
    Timings timings;
    timings.total_seconds = total_seconds;
    std::size_t index = 0;
    for (const runtime::NodeTiming& node : runtime.timing()) {
        const host::InstanceHost& host = *graph.nodes()[index++].host;
        timings.nodes.push_back({node, host.counters(), host.gauges()});
    }
    return timings;
}

nlohmann::ordered_json node_timing(const runtime::NodeTiming& timing) {
    return {{"calls", timing.calls},
            {"seconds", timing.seconds},
            {"mean_seconds", timing.mean_seconds()},
            {"max_seconds", timing.longest_seconds}};
}

nlohmann::ordered_json timing(const Timings& timings) {
    using Json = nlohmann::ordered_json;
    Json document{{"total_seconds", timings.total_seconds}, {"nodes", Json::object()}};
    for (const NodeReport& node : timings.nodes) {
        Json& json = document["nodes"][node.timing.node];
        json = node_timing(node.timing);
        json["counters"] = Json::object();
        json["gauges"] = Json::object();
        for (const auto& [name, value] : node.counters) json["counters"][name] = value;
        for (const auto& [name, gauge] : node.gauges)
            json["gauges"][name] = {{"value", gauge.value},
                                    {"unit", gauge.unit}};  // a non-finite value is written as null
    }
    return document;
}

}  // namespace pelorus::report
