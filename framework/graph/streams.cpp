#include "graph/streams.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "graph/contract.hpp"
#include "host/breadcrumb.hpp"
#include "host/description.hpp"
#include "host/first_size.hpp"
#include "host/plugin_error.hpp"

namespace pelorus::graph {

namespace {

using host::element;

std::string show(const plr_component& component) { return std::string(component.name) + " [" + component.unit + "]"; }

std::string show_frame(const char* frame) {
    return *frame == '\0' ? "the root frame" : "frame '" + std::string(frame) + "'";
}

bool same(const plr_component& a, const plr_component& b) {
    return std::string(a.name) == b.name && std::string(a.unit) == b.unit;
}

/// All components of both sides in turn, or "" if they are the same: `range [m] = range [m]; azimuth [rad] != nothing`.
std::string exact_difference(const plr_space& offered, const plr_space& wanted) {
    std::vector<std::string> pairs;
    bool differs = false;
    for (std::uint32_t i = 0; i < std::max(offered.size, wanted.size); ++i) {
        const plr_component* const left = i < offered.size ? &element(offered.components, i) : nullptr;
        const plr_component* const right = i < wanted.size ? &element(wanted.components, i) : nullptr;
        const bool is_same = left != nullptr && right != nullptr && same(*left, *right);
        differs = differs || !is_same;
        pairs.push_back((left == nullptr ? "nothing" : show(*left)) + (is_same ? " = " : " != ") +
                        (right == nullptr ? "nothing" : show(*right)));
    }
    return differs ? "components, offered against wanted: " + join(pairs, "; ") : std::string();
}

/// The same where the offered space may have further components in between and after.
std::string lacking(const plr_space& offered, const plr_space& wanted) {
    std::vector<std::string> lines, all;
    bool lacks = false;
    std::uint32_t at = 0;
    for (std::uint32_t i = 0; i < wanted.size; ++i) {
        const plr_component& component = element(wanted.components, i);
        std::uint32_t found = at;
        while (found < offered.size && !same(element(offered.components, found), component)) ++found;
        const bool is_there = found < offered.size;
        if (is_there) at = found + 1;
        lacks = lacks || !is_there;
        lines.push_back(show(component) + (is_there ? " is there" : " is missing"));
    }
    for (std::uint32_t i = 0; i < offered.size; ++i) all.push_back(show(element(offered.components, i)));
    if (!lacks) return {};
    return "of the components that are wanted, in this order, " + join(lines, "; ") + "; offered are " +
           join(all, "; ");
}

/// `the stream of sensor 'radar'`, `the stream`
std::string name_of(const plr_stream& stream) {
    return stream.sensor == nullptr || *stream.sensor == '\0'
               ? "the stream"
               : "the stream of sensor '" + std::string(stream.sensor) + "'";
}

/// Why an offered stream does not fit a wanted one, or "".
std::string difference(const plr_stream& offered, const plr_stream& wanted) {
    const bool at_least = (wanted.flags & PLR_STREAM_AT_LEAST) != 0;
    if (wanted.space != nullptr) {
        const std::string text =
            at_least ? lacking(*offered.space, *wanted.space) : exact_difference(*offered.space, *wanted.space);
        if (!text.empty()) return text;
    }
    if (wanted.frame != nullptr && std::string(wanted.frame) != offered.frame)
        return "it is in " + show_frame(offered.frame) + ", wanted in " + show_frame(wanted.frame) +
               "; nodes name theirs by `frame:`";
    return {};
}

class StreamCheck {
public:
    StreamCheck(const std::vector<Node>& nodes, const std::vector<Edge>& edges, Problems& problems)
        : nodes_(nodes), edges_(edges), problems_(problems) {
        collect_offers();
    }

    void check(const Edge& edge) {
        const auto wanted = ask(nodes_[edge.to], false, edge.to_port);
        if (!wanted || wanted->stream_count == 0) return;
        const std::string between = nodes_[edge.from].name + "." + port_name(nodes_[edge.from], true, edge.from_port) +
                                    " -> " + nodes_[edge.to].name + "." +
                                    port_name(nodes_[edge.to], false, edge.to_port) + ": ";
        for (const plr_stream* offered : offers_.at({edge.from, edge.from_port}).streams) {
            const std::string problem = mismatch(*offered, *wanted);
            if (!problem.empty()) problems_.add(edge.where, between + problem);
        }
    }

    const std::vector<const plr_stream*>& offered(const Edge& edge) const {
        return offers_.at({edge.from, edge.from_port}).streams;
    }

private:
    using Port = std::pair<std::size_t, std::size_t>;  ///< node, out port

    struct Offer {
        std::vector<const plr_stream*> streams;
        std::size_t listed = 0;  ///< so many are the port's own
        std::uint32_t passes_on = 0;

        /// Whether a stream that is passed on was not there yet.
        bool take(const plr_stream* passed) {
            for (std::size_t i = 0; i < streams.size(); ++i)
                if (streams[i] == passed || (i < listed && std::string(streams[i]->sensor) == passed->sensor))
                    return false;
            streams.push_back(passed);
            return true;
        }
    };

    /// What comes out of every port that an edge begins at: the streams that it lists, and those that it passes on. Streams
    /// are handed along the edges until nothing is new, so that feedback does no harm.
    void collect_offers() {
        for (const Edge& edge : edges_) {
            Offer offer;
            if (const auto type = ask(nodes_[edge.from], true, edge.from_port)) {
                for (std::uint32_t i = 0; i < type->stream_count; ++i)
                    offer.streams.push_back(&element(type->streams, i));
                offer.listed = offer.streams.size();
                offer.passes_on = type->passes_on;
            }
            offers_.emplace(Port{edge.from, edge.from_port}, std::move(offer));
        }
        for (bool is_new = true; is_new;) {
            is_new = false;
            for (auto& [port, offer] : offers_)
                for (const Edge& edge : edges_) {
                    if (offer.passes_on == 0 || edge.to != port.first || edge.to_port + 1 != offer.passes_on) continue;
                    for (const plr_stream* stream :
                         std::vector<const plr_stream*>(offers_.at({edge.from, edge.from_port}).streams))
                        is_new = offer.take(stream) || is_new;
                }
        }
    }

    static std::string port_name(const Node& node, bool is_output, std::size_t port) {
        const plr_description& description = node.description();
        return element(is_output ? description.out_ports : description.in_ports, static_cast<std::uint32_t>(port)).name;
    }

    /// Nothing if the answer is not usable; that is then a problem.
    std::optional<plr_port_type> ask(const Node& node, bool is_output, std::size_t port) {
        plr_port_type type{};
        type.struct_size = sizeof type;
        const bool answers =
            node.stage().head.struct_size >= offsetof(plr_stage, port_type) + sizeof(node.stage().port_type) &&
            node.stage().port_type != nullptr;
        if (!answers) return type;
        const std::string label = node.name + "." + port_name(node, is_output, port) + ": ";
        plr_error error = host::empty_error();
        const plr_status status = host::guarded(error, [&] {
            const std::string name = port_name(node, is_output, port);
            const host::Breadcrumb crumb({node.name.c_str(), node.description().id, "port_type", name.c_str()});
            return node.stage().port_type(node.instance.self, is_output ? 1 : 0, static_cast<std::uint32_t>(port),
                                          &type, &error);
        });
        if (status != PLR_OK) {
            problems_.add(node.where, label + node.description().id + ": " + host::error_text(status, error));
            return std::nullopt;
        }
        const std::string problem = type_problem(type, is_output, node.description().in_port_count);
        if (problem.empty()) return type;
        problems_.add(node.where, label + node.description().id + " " + problem);
        return std::nullopt;
    }

    static std::string type_problem(const plr_port_type& type, bool is_output, std::uint32_t in_port_count) {
        if (is_output && type.passes_on > in_port_count)
            return "passes on the streams of an in port that it does not have";
        if (type.stream_count == 0) return {};
        if (type.streams == nullptr || type.streams->struct_size < host::first_size<plr_stream>)
            return "declares streams that cannot be read";
        for (std::uint32_t i = 0; i < type.stream_count; ++i) {
            const plr_stream& stream = element(type.streams, i);
            const std::string space = space_problem(stream.space, false);
            if (!space.empty() && (is_output || stream.space != nullptr))
                return "declares a stream whose space " + space;
            if (is_output && (stream.frame == nullptr || stream.sensor == nullptr))
                return "offers a stream without a frame or sensor (NULL)";
        }
        return {};
    }

    /// Why no wanted stream takes the offered one, or "".
    static std::string mismatch(const plr_stream& offered, const plr_port_type& wanted) {
        std::string first_problem;
        bool is_named = false;
        for (std::uint32_t i = 0; i < wanted.stream_count; ++i) {
            const plr_stream& stream = element(wanted.streams, i);
            is_named = is_named || (stream.sensor != nullptr && std::string(stream.sensor) == offered.sensor);
        }
        std::vector<std::string> sensors;
        for (std::uint32_t i = 0; i < wanted.stream_count; ++i) {
            const plr_stream& stream = element(wanted.streams, i);
            if (stream.sensor != nullptr) sensors.push_back("'" + std::string(stream.sensor) + "'");
            if (is_named ? stream.sensor == nullptr || std::string(stream.sensor) != offered.sensor
                         : stream.sensor != nullptr)
                continue;
            const std::string problem = difference(offered, stream);
            if (problem.empty()) return {};
            if (first_problem.empty()) first_problem = problem;
        }
        if (!first_problem.empty()) return name_of(offered) + " does not fit: " + first_problem;
        return name_of(offered) +
               " is not wanted there; scans go to sensors by name, and these are wanted: " + join(sensors);
    }

    const std::vector<Node>& nodes_;
    const std::vector<Edge>& edges_;
    Problems& problems_;
    std::map<Port, Offer> offers_;
};

}  // namespace

std::vector<std::vector<const plr_stream*>> check_streams(const std::vector<Node>& nodes,
                                                          const std::vector<Edge>& edges, Problems& problems) {
    StreamCheck check(nodes, edges, problems);
    std::vector<std::vector<const plr_stream*>> streams;
    for (const Edge& edge : edges) {
        check.check(edge);
        streams.push_back(check.offered(edge));
    }
    return streams;
}

}  // namespace pelorus::graph
