/// What the runtime needs to know of a graph, in plain structs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <pelorus/abi/abi.h>

#include "graph/graph.hpp"
#include "host/guard/mode.hpp"
#include "host/services.hpp"

namespace pelorus::runtime {

struct Wiring {
    struct Port {
        std::string name;
        std::uint32_t message = 0;        ///< PLR_MESSAGE_...
        std::vector<plr_stream> streams;  ///< offered (passed-on ones included) or wanted; none: everything goes
        std::uint32_t passes_on = 0;      ///< 1 + the in port whose streams come out here, too
    };
    struct Node {
        std::string name, plugin, kind, version;
        plr_instance instance{};
        host::InstanceHost* host = nullptr;
        std::vector<Port> in_ports, out_ports;
    };
    std::vector<Node> nodes;  ///< in file order
    std::vector<graph::Edge> edges;
    host::GuardMode guard = host::GuardMode::start;  ///< whether deliveries are checked
    std::vector<std::size_t> order;                  ///< every edge but the feedback ones goes forward
    /// Everything else that determines the run, as JSON text: two runs with the same text are the same run.
    /// "": no snapshot of it is ever taken.
    std::string parameters;
};

/// A stage's functions; those that its table is too short for are NULL.
plr_stage stage_functions(const plr_instance& instance);

/// A node from its plugin's description and its instance; asks the instance what its ports carry. Throws Error.
Wiring::Node wire_node(std::string name, const plr_description& description, plr_instance instance,
                       host::InstanceHost* host);

/// Adds to the out ports that pass streams on what comes in at those in ports.
void resolve_streams(Wiring& wiring);

/// All that determines the runs of a graph but the plugins' binaries: seed, config as resolved (of paths the last part alone) and
/// the plugins' versions.
nlohmann::ordered_json determinants(const graph::Graph& graph);

/// Whether a run may be snapshotted: telling all that determines it takes longer than everything else here.
enum class Snapshots { possible, none };

/// All of a graph. Throws Error when a stage does not answer what its ports carry.
Wiring wire(const graph::Graph& graph, Snapshots snapshots = Snapshots::possible);

}  // namespace pelorus::runtime
