#include "graph/graph.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "graph/frames.hpp"
#include "graph/instance.hpp"
#include "graph/overrides.hpp"
#include "graph/plan.hpp"
#include "graph/plugins.hpp"
#include "graph/problems.hpp"
#include "graph/resolved.hpp"
#include "graph/settings.hpp"
#include "graph/streams.hpp"
#include "graph/wiring.hpp"

namespace pelorus::graph {

namespace {

Variables variables_of(const BuildOptions& options) {
    return [&options](const std::string& name) -> std::optional<std::string> {
        const auto own = options.variables.find(name);
        if (own != options.variables.end()) return own->second;
        const char* value = std::getenv(name.c_str());
        return value == nullptr ? std::nullopt : std::optional<std::string>(value);
    };
}

const Value* graph_block(const Value& root, Problems& problems) {
    const Value* graph = root.find("graph");
    if (graph != nullptr && graph->is_map() && !graph->map.empty()) return graph;
    problems.add(graph == nullptr ? root.where : graph->where,
                 graph == nullptr ? "the config has no `graph:`"
                                  : "graph: expected a map from names to nodes, got " +
                                        (graph->is_map() ? std::string("an empty one") : graph->described()));
    return nullptr;
}

void check_frames(const std::vector<NodePlan>& nodes, const nlohmann::ordered_json& frames, Problems& problems) {
    std::vector<std::string> names;
    for (const auto& [name, frame] : frames.items()) names.push_back(name);
    for (const NodePlan& node : nodes)
        if (!node.frame.empty() && std::find(names.begin(), names.end(), node.frame) == names.end())
            problems.add(node.frame_where, node.name + ".frame: there is no frame '" + node.frame + "'" +
                                               suggestion(node.frame, names, "frames"));
}

void remove_sinks(std::vector<NodePlan>& nodes) {
    const auto is_sink = [](const NodePlan& node) {
        return node.part != nullptr && std::string(node.part->description().kind) == "sink";
    };
    nodes.erase(std::remove_if(nodes.begin(), nodes.end(), is_sink), nodes.end());
}

void collect_plugins(const PartPlan& part, std::map<std::string, const host::LoadedPlugin*>& found) {
    found.emplace(part.description().id, part.plugin);
    for (const std::unique_ptr<PartPlan>& below : part.parts) collect_plugins(*below, found);
}

}  // namespace

struct Graph::Implementation {
    Settings settings;
    std::uint64_t seed = 0;
    std::uint64_t run = 0;
    std::string output_folder;
    host::GuardMode guard = host::GuardMode::start;
    host::FrameTree frames;
    std::unique_ptr<host::ThreadPool> pool;
    std::vector<NodePlan> plans;
    std::vector<Edge> edges;
    std::vector<std::vector<const plr_stream*>> streams;
    std::vector<std::size_t> order;
    nlohmann::ordered_json resolved;
    Instances instances;  // after all that they use: they are destroyed first
    std::vector<Node> nodes;

    Implementation(const Document& document, const PluginFinder& finder, const BuildOptions& options)
        : run(options.run), output_folder(options.output_folder), guard(options.guard) {
        check(document, finder, options);
        pool = std::make_unique<host::ThreadPool>(options.threads);
    }

    /// Everything that can be said without making an instance.
    void check(const Document& document, const PluginFinder& finder, const BuildOptions& options) {
        Problems problems;
        Plugins plugins(finder);
        Value root = document.root();
        apply_overrides(root, document.overrides(), plugins.descriptions(), problems);
        settings = read_settings(root, problems);
        seed = settings.seed.value_or(options.seed);
        nlohmann::ordered_json frames_json = read_frames(root.find("frames"), frames, problems);
        if (const Value* graph = graph_block(root, problems)) {
            plans = plan_graph(*graph, {plugins, problems, root.base, variables_of(options)});
            check_frames(plans, frames_json, problems);
            if (!options.sinks) remove_sinks(plans);
            edges = read_edges(plans, problems);
            order = order_of(plans, edges, problems);
        }
        problems.raise();
        resolved = {{"pelorus", 1}, {"title", settings.title}, {"run", {{"seed", seed}}}};
        if (!frames_json.empty()) resolved["frames"] = std::move(frames_json);
        resolved["graph"] = graph_json(plans, edges);
    }

    void destroy() noexcept {
        nodes.clear();
        streams.clear();
        instances.clear();
    }

    void create() {
        Problems problems;
        for (const NodePlan& plan : plans) {
            const TreeContext context{{&frames, pool.get(), &output_folder, std::make_shared<host::FaultLatch>()},
                                      host::node_key(seed, run, plan.name),
                                      plan.frame.c_str(),
                                      guard};
            Instance* instance = instances.create(*plan.part, context, problems);
            if (instance == nullptr) continue;
            Node node;
            node.name = plan.name;
            node.where = plan.where;
            node.plugin = plan.part->plugin;
            node.instance = instance->instance();
            node.config = &instance->config();
            node.host = &instance->host();
            nodes.push_back(std::move(node));
        }
        problems.raise();
        streams = check_streams(nodes, edges, problems);
        problems.raise();
    }
};

Graph Graph::build(const Document& document, host::Catalog& catalog, const BuildOptions& options) {
    return build(
        document, [&catalog](const std::string& id) -> const host::LoadedPlugin& { return catalog.load(id); }, options);
}

Graph Graph::build(const Document& document, const PluginFinder& finder, const BuildOptions& options) {
    auto implementation = std::make_unique<Implementation>(document, finder, options);
    implementation->create();
    return Graph(std::move(implementation));
}

Graph Graph::plan(const Document& document, const PluginFinder& finder, const BuildOptions& options) {
    return Graph(std::make_unique<Implementation>(document, finder, options));
}

void Graph::renew(const BuildOptions& options) {
    implementation_->destroy();
    implementation_->run = options.run;
    implementation_->guard = options.guard;
    implementation_->output_folder = options.output_folder;
    implementation_->create();
}

void Graph::clear() noexcept { implementation_->destroy(); }

Graph::Graph(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Graph::Graph(Graph&&) noexcept = default;
Graph& Graph::operator=(Graph&&) noexcept = default;
Graph::~Graph() = default;

const std::string& Graph::title() const noexcept { return implementation_->settings.title; }
std::uint64_t Graph::seed() const noexcept { return implementation_->seed; }
std::uint64_t Graph::run() const noexcept { return implementation_->run; }
const std::vector<Node>& Graph::nodes() const noexcept { return implementation_->nodes; }
const std::vector<Edge>& Graph::edges() const noexcept { return implementation_->edges; }
const std::vector<std::size_t>& Graph::order() const noexcept { return implementation_->order; }
const std::vector<NodePlan>& Graph::plans() const noexcept { return implementation_->plans; }
const std::vector<const plr_stream*>& Graph::streams(std::size_t edge) const {
    return implementation_->streams.at(edge);
}
nlohmann::ordered_json Graph::resolved() const { return implementation_->resolved; }
host::GuardMode Graph::guard() const noexcept { return implementation_->guard; }
host::ThreadPool& Graph::pool() noexcept { return *implementation_->pool; }

std::vector<plr_part> Graph::models() const { return implementation_->instances.models(); }

std::vector<const host::LoadedPlugin*> Graph::plugins() const {
    std::map<std::string, const host::LoadedPlugin*> found;
    for (const NodePlan& plan : implementation_->plans) collect_plugins(*plan.part, found);
    std::vector<const host::LoadedPlugin*> sorted;
    for (const auto& [id, plugin] : found) sorted.push_back(plugin);
    return sorted;
}

}  // namespace pelorus::graph
