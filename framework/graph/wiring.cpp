#include "graph/wiring.hpp"

#include <algorithm>
#include <optional>
#include <queue>
#include <string>

#include "graph/names.hpp"
#include "host/description.hpp"
#include "host/kinds.hpp"

namespace pelorus::graph {

namespace {

using host::element;

std::vector<std::string> port_names(const plr_port* ports, std::uint32_t count) {
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < count; ++i) names.emplace_back(element(ports, i).name);
    return names;
}

std::optional<std::size_t> index_of(const std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) return std::nullopt;
    return static_cast<std::size_t>(found - names.begin());
}

class EdgeReader {
public:
    EdgeReader(const std::vector<NodePlan>& nodes, Problems& problems) : nodes_(nodes), problems_(problems) {
        for (const NodePlan& node : nodes) names_.push_back(node.name);
    }

    std::vector<Edge> read() {
        for (std::size_t i = 0; i < nodes_.size(); ++i)
            if (nodes_[i].part != nullptr) read_node(i);
        return std::move(edges_);
    }

private:
    void read_node(std::size_t index) {
        const NodePlan& node = nodes_[index];
        const plr_description& description = node.part->description();
        const std::vector<std::string> ports = port_names(description.in_ports, description.in_port_count);
        for (const Value::Entry& entry : node.in.map)
            if (!index_of(ports, entry.key))
                problems_.add(entry.where, node.name + ".in: " + description.id + " has no in port '" + entry.key +
                                               "'" + suggestion(entry.key, ports, "in ports"));
        const Value in = mended(node.in, ports);
        for (std::uint32_t port = 0; port < description.in_port_count; ++port) {
            const plr_port& described = element(description.in_ports, port);
            const Value* from = in.find(described.name);
            if (from != nullptr)
                read_port(index, port, described, *from);
            else if ((described.flags & PLR_PORT_OPTIONAL) == 0)
                problems_.add(node.part->use_where, node.name + ": the in port '" + described.name + "' (" +
                                                        host::message_kind_name(described.message) +
                                                        ") is not connected" + publishers(described, index));
        }
    }

    /// `; scan comes from world.scans`: what could be connected to an in port of a node.
    std::string publishers(const plr_port& wanted, std::size_t to) const {
        std::vector<std::string> ports;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (nodes_[i].part == nullptr || i == to) continue;
            const plr_description& description = nodes_[i].part->description();
            for (std::uint32_t port = 0; port < description.out_port_count; ++port) {
                const plr_port& offered = element(description.out_ports, port);
                if (offered.message == wanted.message) ports.push_back(nodes_[i].name + "." + offered.name);
            }
        }
        if (ports.empty()) return std::string("; no node publishes ") + host::message_kind_name(wanted.message);
        constexpr std::size_t few = 6;
        if (ports.size() > few) return {};
        return std::string("; ") + host::message_kind_name(wanted.message) + " comes from " + join(ports);
    }

    void read_port(std::size_t node, std::uint32_t port, const plr_port& described, const Value& from) {
        const std::string label = nodes_[node].name + ".in." + described.name;
        if (from.is_scalar()) return read_edge(node, port, described, from, label);
        if (!from.is_list() || from.list.empty()) {
            problems_.add(from.where, label + ": expected node.port or previous(node.port), got " + from.described());
            return;
        }
        if (from.list.size() > 1 && (described.flags & PLR_PORT_MANY) == 0) {
            problems_.add(from.where, label + ": one edge may end here, got " + std::to_string(from.list.size()));
            return;
        }
        for (const Value& item : from.list) {
            if (item.is_scalar())
                read_edge(node, port, described, item, label);
            else
                problems_.add(item.where,
                              label + ": expected node.port or previous(node.port), got " + item.described());
        }
    }

    void read_edge(std::size_t node, std::uint32_t port, const plr_port& described, const Value& text,
                   const std::string& label) {
        Edge edge{};
        edge.to = node;
        edge.to_port = port;
        edge.where = text.where;
        std::string address = text.scalar;
        const std::string opening = "previous(";
        if (address.compare(0, opening.size(), opening) == 0 && address.back() == ')') {
            edge.previous = true;
            address = address.substr(opening.size(), address.size() - opening.size() - 1);
        }
        const std::vector<std::string> segments = split_address(address);
        if (segments.size() != 2 || !is_name(segments[0]) || segments[1].empty()) {
            problems_.add(text.where, label + ": expected node.port or previous(node.port), got '" + text.scalar + "'" +
                                          publishers(described, node));
            return;
        }
        const auto from = index_of(names_, segments[0]);
        if (!from) {
            problems_.add(text.where, label + ": there is no node '" + segments[0] + "'" +
                                          suggestion(segments[0], names_, "nodes"));
            return;
        }
        edge.from = *from;
        if (nodes_[edge.from].part != nullptr && find_out_port(edge, segments[1], described, label)) add(edge, label);
    }

    bool find_out_port(Edge& edge, const std::string& port, const plr_port& described, const std::string& label) {
        const plr_description& from = nodes_[edge.from].part->description();
        const std::vector<std::string> ports = port_names(from.out_ports, from.out_port_count);
        const auto found = index_of(ports, port);
        if (!found) {
            problems_.add(edge.where, label + ": " + from.id + " has no out port '" + port + "'" +
                                          suggestion(port, ports, "out ports"));
            return false;
        }
        edge.from_port = *found;
        const std::uint32_t carried = element(from.out_ports, static_cast<std::uint32_t>(*found)).message;
        if (carried == described.message) return true;
        problems_.add(edge.where, label + ": expected " + host::message_kind_name(described.message) + ", but " +
                                      nodes_[edge.from].name + "." + port + " carries " +
                                      host::message_kind_name(carried) + publishers(described, edge.to));
        return false;
    }

    void add(const Edge& edge, const std::string& label) {
        for (const Edge& other : edges_)
            if (other.to == edge.to && other.to_port == edge.to_port && other.from == edge.from &&
                other.from_port == edge.from_port) {
                problems_.add(edge.where, label + ": the same edge stands twice");
                return;
            }
        edges_.push_back(edge);
    }

    const std::vector<NodePlan>& nodes_;
    Problems& problems_;
    std::vector<std::string> names_;
    std::vector<Edge> edges_;
};

/// Among nodes that all wait for others: follows edges backwards until a node comes twice.
void report_cycle(const std::vector<NodePlan>& nodes, const std::vector<Edge>& edges,
                  const std::vector<std::size_t>& waiting, Problems& problems) {
    std::vector<std::size_t> path;
    Location where;
    const auto first = std::find_if(waiting.begin(), waiting.end(), [](std::size_t count) { return count > 0; });
    auto at = static_cast<std::size_t>(first - waiting.begin());
    while (std::find(path.begin(), path.end(), at) == path.end()) {
        path.push_back(at);
        for (const Edge& edge : edges) {
            if (edge.previous || edge.to != at || waiting[edge.from] == 0) continue;
            at = edge.from;
            where = edge.where;
            break;
        }
    }
    path.erase(path.begin(), std::find(path.begin(), path.end(), at));
    std::string text = nodes[at].name;
    for (auto node = path.rbegin(); node != path.rend(); ++node) text += " -> " + nodes[*node].name;
    problems.add(where,
                 "nodes wait for each other in a circle: " + text + "; write one of the edges as previous(node.port)");
}

}  // namespace

std::vector<Edge> read_edges(const std::vector<NodePlan>& nodes, Problems& problems) {
    return EdgeReader(nodes, problems).read();
}

std::vector<std::size_t> order_of(const std::vector<NodePlan>& nodes, const std::vector<Edge>& edges,
                                  Problems& problems) {
    std::vector<std::size_t> waiting(nodes.size(), 0), order;
    for (const Edge& edge : edges)
        if (!edge.previous) ++waiting[edge.to];
    std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>> ready;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (waiting[i] == 0) ready.push(i);
    while (!ready.empty()) {
        const std::size_t node = ready.top();
        ready.pop();
        order.push_back(node);
        for (const Edge& edge : edges)
            if (!edge.previous && edge.from == node && --waiting[edge.to] == 0) ready.push(edge.to);
    }
    if (order.size() != nodes.size()) report_cycle(nodes, edges, waiting, problems);
    return order;
}

}  // namespace pelorus::graph
