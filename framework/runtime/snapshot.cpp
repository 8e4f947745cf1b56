#include "runtime/snapshot.hpp"

#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <sodium.h>

#include "host/error.hpp"
#include "runtime/bytes.hpp"
#include "runtime/config_difference.hpp"
#include "runtime/message_bytes.hpp"
#include "runtime/message_check.hpp"

namespace pelorus::runtime {
namespace {

constexpr char magic[8] = {'P', 'L', 'R', 'S', 'N', 'A', 'P', '\n'};
constexpr std::uint32_t format_version = 2;  // 2: the config as text, so that a difference can be named
constexpr std::size_t head_size = sizeof magic + sizeof format_version + sizeof(std::uint64_t);

static_assert(std::tuple_size_v<Digest> == crypto_hash_sha256_BYTES);

[[noreturn]] void refuse(const std::string& text) { throw Error(Exit::run_failed, "snapshot refused: " + text); }

void write_optional(ByteWriter& writer, const std::optional<std::int64_t>& x) {
    writer.number(static_cast<std::uint8_t>(x.has_value()));
    if (x) writer.number(*x);
}
std::optional<std::int64_t> read_optional(ByteReader& reader) {
    if (!reader.flag()) return std::nullopt;
    return reader.number<std::int64_t>();
}

void write_origin(ByteWriter& writer, const Wiring& wiring) {
    writer.number(std::uint64_t{wiring.nodes.size()});
    for (const Wiring::Node& node : wiring.nodes) {
        writer.text(node.name);
        writer.text(node.plugin);
        writer.text(node.version);
    }
    writer.text(wiring.parameters);
    const Digest digest = digest_of(wiring);
    writer.block(digest.data(), digest.size());
}

void check_origin(ByteReader& reader, const Wiring& wiring) {
    const std::size_t count = reader.count(24);
    std::size_t index = 0;
    for (; index < count; ++index) {
        const std::string name = reader.text(), plugin = reader.text(), version = reader.text();
        if (index >= wiring.nodes.size())
            refuse(fmt::format("it has a node {} ({}) that this graph has not", name, plugin));
        const Wiring::Node& node = wiring.nodes[index];
        if (name != node.name || plugin != node.plugin || version != node.version)
            refuse(fmt::format("it was taken from node {} ({} {}), but this graph has {} ({} {}) in its place", name,
                               plugin, version, node.name, node.plugin, node.version));
    }
    if (index < wiring.nodes.size())
        refuse(fmt::format("it has no node {}, which this graph has", wiring.nodes[index].name));
    const std::string parameters = reader.text();
    Digest digest{};
    reader.block(digest.data(), digest.size());
    if (digest == digest_of(wiring)) return;
    const std::string difference = first_difference(parameters, wiring.parameters);
    refuse(difference.empty()
               ? "it was taken from a graph with the same nodes, but other edges, parameters, parts or seed"
               : "it was taken from another config: " + difference);
}

void write_node(ByteWriter& writer, const Snapshot::Node& node) {
    writer.number(static_cast<std::uint8_t>(node.state.has_value()));
    if (node.state) writer.sized(node.state->data(), node.state->size());
    writer.number(static_cast<std::uint8_t>(node.ended));
    write_optional(writer, node.last_emitted);
    writer.number(std::uint64_t{node.counters.size()});
    for (const auto& [name, value] : node.counters) {
        writer.text(name);
        writer.number(value);
    }
    writer.number(std::uint64_t{node.gauges.size()});
    for (const auto& [name, gauge] : node.gauges) {
        writer.text(name);
        writer.text(gauge.unit);
        writer.number(gauge.value);
    }
}

Snapshot::Node read_node(ByteReader& reader) {
    Snapshot::Node node;
    if (reader.flag()) node.state = reader.sized();
    node.ended = reader.flag();
    node.last_emitted = read_optional(reader);
    for (std::size_t left = reader.count(16); left > 0; --left) {
        std::string name = reader.text();
        node.counters[std::move(name)] = reader.number<std::int64_t>();
    }
    for (std::size_t left = reader.count(24); left > 0; --left) {
        host::InstanceHost::Gauge& gauge = node.gauges[reader.text()];
        gauge.unit = reader.text();
        gauge.value = reader.number<double>();
    }
    return node;
}

/// A message of the out port that it says it came from.
Event read_event(ByteReader& reader, const Wiring& wiring, std::size_t node, std::size_t port, MessagePool& pool) {
    if (node >= wiring.nodes.size() || port >= wiring.nodes[node].out_ports.size())
        throw CorruptBytes("a message comes from a port that is not there");
    Event event;
    event.message = read_message(reader, pool);
    const Wiring::Port& out = wiring.nodes[node].out_ports[port];
    if (event.message->kind != out.message) throw CorruptBytes("a message is not of its port's kind");
    try {
        check_stream(*event.message, out.streams);
    } catch (const BadMessage& problem) {
        throw CorruptBytes(problem.what());
    }
    event.message.writable().origin = wiring.nodes[node].name.c_str();
    event.key = {event.message->arrival, event.message->time, node, event.message->sequence};
    return event;
}

void check_order(const std::vector<Event>& events, const Snapshot& snapshot) {
    for (std::size_t i = 0; i < events.size(); ++i) {
        if (events[i].key.sequence >= snapshot.sequence)
            throw CorruptBytes("a message is numbered higher than there were messages");
        if (i > 0 && !(events[i - 1] < events[i])) throw CorruptBytes("messages are not in order");
    }
}

void write_events(ByteWriter& writer, const std::vector<Event>& events) {
    writer.number(std::uint64_t{events.size()});
    for (const Event& event : events) {
        writer.number(std::uint64_t{event.key.node});
        writer.number(event.channel);
        write_message(writer, *event.message);
    }
}

std::vector<Event> read_queue(ByteReader& reader, const Wiring& wiring, const Snapshot& snapshot, MessagePool& pool) {
    std::vector<Event> events;
    for (std::size_t left = reader.count(40); left > 0; --left) {
        const auto node = static_cast<std::size_t>(reader.number<std::uint64_t>());
        const auto port = reader.number<std::uint32_t>();
        events.push_back(read_event(reader, wiring, node, port, pool));
        events.back().channel = port;
        if (!snapshot.now || events.back().key.arrival < *snapshot.now)
            throw CorruptBytes("a message arrives in the past");
    }
    check_order(events, snapshot);
    return events;
}

/// What waits at the feedback edges of a node.
std::vector<Event> read_feedback(ByteReader& reader, const Wiring& wiring, std::size_t node, const Snapshot& snapshot,
                                 MessagePool& pool) {
    std::vector<Event> events;
    for (std::size_t left = reader.count(40); left > 0; --left) {
        const auto from = static_cast<std::size_t>(reader.number<std::uint64_t>());
        const auto index = reader.number<std::uint32_t>();
        if (index >= wiring.edges.size()) throw CorruptBytes("a message waits at an edge that is not there");
        const graph::Edge& edge = wiring.edges[index];
        if (!edge.previous || edge.from != from || edge.to != node)
            throw CorruptBytes("a message waits at an edge that is not its own");
        events.push_back(read_event(reader, wiring, edge.from, edge.from_port, pool));
        events.back().channel = index;
    }
    check_order(events, snapshot);
    return events;
}

Snapshot read_content(ByteReader& reader, const Wiring& wiring, MessagePool& pool) {
    check_origin(reader, wiring);
    Snapshot snapshot;
    std::vector<std::string> names;
    for (const Wiring::Node& node : wiring.nodes) {
        names.push_back(node.name);
        snapshot.nodes.push_back(read_node(reader));
    }
    snapshot.now = read_optional(reader);
    snapshot.sequence = reader.number<std::uint64_t>();
    snapshot.events = read_queue(reader, wiring, snapshot, pool);
    for (std::size_t node = 0; node < wiring.nodes.size(); ++node)
        snapshot.feedback.push_back(read_feedback(reader, wiring, node, snapshot, pool));
    snapshot.results.read(reader, names);
    if (reader.left() != 0) throw CorruptBytes("bytes are left over");
    return snapshot;
}

}  // namespace

Digest sha256(const void* bytes, std::size_t size) {
    Digest digest{};
    crypto_hash_sha256(digest.data(), static_cast<const unsigned char*>(bytes), size);
    return digest;
}

Digest digest_of(const Wiring& wiring) {
    ByteWriter text;
    for (const Wiring::Node& node : wiring.nodes)
        for (const std::string* part : {&node.name, &node.plugin, &node.version}) text.text(*part);
    for (const graph::Edge& edge : wiring.edges)
        for (const std::size_t end : {edge.from, edge.from_port, edge.to, edge.to_port, std::size_t{edge.previous}})
            text.number(std::uint64_t{end});
    text.text(wiring.parameters);
    return sha256(text.bytes().data(), text.bytes().size());
}

std::vector<unsigned char> to_bytes(const Snapshot& snapshot, const Wiring& wiring) {
    ByteWriter content;
    write_origin(content, wiring);
    for (const Snapshot::Node& node : snapshot.nodes) write_node(content, node);
    write_optional(content, snapshot.now);
    content.number(snapshot.sequence);
    write_events(content, snapshot.events);
    for (const std::vector<Event>& waiting : snapshot.feedback) write_events(content, waiting);
    snapshot.results.write(content);

    ByteWriter whole;
    whole.block(magic, sizeof magic);
    whole.number(format_version);
    whole.sized(content.bytes().data(), content.bytes().size());
    const Digest digest = sha256(whole.bytes().data(), whole.bytes().size());
    whole.block(digest.data(), digest.size());
    return std::move(whole.bytes());
}

Snapshot from_bytes(const std::vector<unsigned char>& bytes, const Wiring& wiring, MessagePool& pool) {
    if (bytes.size() < sizeof magic || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
        refuse("it does not begin as a snapshot does");
    try {
        ByteReader head(bytes.data() + sizeof magic, bytes.size() - sizeof magic);
        const auto version = head.number<std::uint32_t>();
        if (version != format_version) refuse(fmt::format("it has format {}, expected {}", version, format_version));
        const auto size = head.number<std::uint64_t>();
        if (head.left() < sizeof(Digest) || head.left() - sizeof(Digest) != size)
            refuse(fmt::format("it is truncated or has bytes too many: {} bytes for {} bytes of content", bytes.size(),
                               size));
        const std::size_t end = bytes.size() - sizeof(Digest);
        if (std::memcmp(sha256(bytes.data(), end).data(), bytes.data() + end, sizeof(Digest)) != 0)
            refuse("it is damaged: its checksum does not fit");
        ByteReader content(bytes.data() + head_size, end - head_size);
        return read_content(content, wiring, pool);
    } catch (const CorruptBytes& problem) {
        refuse(std::string("it is damaged: ") + problem.what());
    }
}

}  // namespace pelorus::runtime
