/// A config, checked and wired: instances of stages with their trees of parts, and the edges between them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <pelorus/abi/abi.h>

#include "graph/document.hpp"
#include "host/catalog.hpp"
#include "host/error.hpp"
#include "host/guard/mode.hpp"
#include "host/services.hpp"

namespace pelorus::graph {

struct Edge {
    std::size_t from, from_port;  ///< node index, out port index
    std::size_t to, to_port;      ///< node index, in port index
    bool previous = false;        ///< a feedback edge: what was published strictly before this arrival (ABI stage.h)
    Location where;
};

struct Node {
    std::string name;
    Location where;  ///< of its name in the config
    const host::LoadedPlugin* plugin = nullptr;
    plr_instance instance{};             ///< self and table of the stage
    const plr_config* config = nullptr;  ///< what it was created from (inputs of its tree, frame, key)
    host::InstanceHost* host = nullptr;  ///< to connect publish, and for its counters
    const plr_stage& stage() const { return *reinterpret_cast<const plr_stage*>(instance.table); }
    const plr_description& description() const { return plugin->description(); }
};

struct BuildOptions {
    std::uint64_t seed = 0;  ///< where the config has no `run: {seed: ...}` and the command line none either
    std::uint64_t run = 0;   ///< number of the run within a campaign cell
    unsigned threads = 1;
    /// Variables that path parameters may name; the environment's are looked up after these.
    std::map<std::string, std::string> variables;
    bool sinks = true;  ///< false: nodes of that kind are left out, once they are checked; nothing comes out of them
    /// The result folder, absolute, for plugins that write files (ABI output.h); "" : none.
    std::string output_folder;
    /// How closely calls of models and deliveries to stages are checked. Results do not depend on it.
    host::GuardMode guard = host::GuardMode::start;
};

/// Answers the plugin of an id, which then stays loaded, or throws Error.
using PluginFinder = std::function<const host::LoadedPlugin&(const std::string& id)>;

struct NodePlan;

class Graph {
public:
    /// Checks the whole document against the plugins' descriptions, creates all instances (parts before holders) and joins
    /// them. Throws ConfigError with everything found, each with file:line:column.
    ///
    /// The catalog must outlive the graph. One run of the base config is built: `campaign:` is checked in its structure and
    /// otherwise left alone.
    static Graph build(const Document& document, host::Catalog& catalog, const BuildOptions& options);
    /// The same with plugins from elsewhere than a catalog.
    static Graph build(const Document& document, const PluginFinder& finder, const BuildOptions& options);
    /// Checks the document like build(), and makes no instance: nodes() is empty until the graph is renewed.
    static Graph plan(const Document& document, const PluginFinder& finder, const BuildOptions& options);
    /// Makes all instances anew, as build() makes them for another run of the same config: what was checked stays checked. Of the
    /// options, `run`, `guard` and `output_folder` count. Throws ConfigError when a plugin refuses; the graph can only be renewed
    /// again or destroyed then. [main], and no runtime of the graph may be left.
    void renew(const BuildOptions& options);
    /// Destroys all instances. [main], as above.
    void clear() noexcept;
    Graph(Graph&&) noexcept;
    Graph& operator=(Graph&&) noexcept;
    ~Graph();

    const std::string& title() const noexcept;
    std::uint64_t seed() const noexcept;
    /// Number of the run within a campaign cell.
    std::uint64_t run() const noexcept;
    host::GuardMode guard() const noexcept;
    /// In file order.
    const std::vector<Node>& nodes() const noexcept;
    const std::vector<Edge>& edges() const noexcept;
    /// Node indices such that every edge but the feedback ones goes forward; ties in file order.
    const std::vector<std::size_t>& order() const noexcept;
    /// What each node is made of, in file order: plan.hpp tells more.
    const std::vector<NodePlan>& plans() const noexcept;
    /// The streams that flow through the edge of that index: sensors, spaces, frames. They live as long as the graph.
    const std::vector<const plr_stream*>& streams(std::size_t edge) const;
    /// Every plugin that stands anywhere in the graph, once, sorted by id.
    std::vector<const host::LoadedPlugin*> plugins() const;
    /// Every model that stands in a slot anywhere in the graph, parts before holders. Valid as long as the graph.
    std::vector<plr_part> models() const;
    /// The config as resolved: extended, overridden, defaults filled in, SI units; a config itself, that builds the same graph.
    /// For provenance.json.
    nlohmann::ordered_json resolved() const;
    host::ThreadPool& pool() noexcept;

private:
    struct Implementation;
    explicit Graph(std::unique_ptr<Implementation>);
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace pelorus::graph
