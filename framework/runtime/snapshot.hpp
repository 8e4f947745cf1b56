/// A run at one moment, as bytes.
///
/// Layout: magic, format version, size of the content, content, SHA-256 of all before it. The content begins with what
/// the snapshot was taken from (nodes, plugins, digest of everything that determines the run), so that another graph is
/// refused by name before anything is changed.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/services.hpp"
#include "runtime/event_queue.hpp"
#include "runtime/result.hpp"
#include "runtime/wiring.hpp"

namespace pelorus::runtime {

using Digest = std::array<unsigned char, 32>;

/// SHA-256. A snapshot ends with that of all bytes before it.
Digest sha256(const void* bytes, std::size_t size);

/// Of nodes, edges, plugins with their versions, and parameters.
Digest digest_of(const Wiring& wiring);

struct Snapshot {
    struct Node {
        std::optional<std::vector<unsigned char>> state;
        bool ended = false;                        ///< of a source
        std::optional<std::int64_t> last_emitted;  ///< ns, of a source
        std::map<std::string, std::int64_t> counters;
        std::map<std::string, host::InstanceHost::Gauge> gauges;
    };
    std::vector<Node> nodes;                   ///< in file order
    std::optional<std::int64_t> now;           ///< ns: arrival of the event handled last
    std::uint64_t sequence = 0;                ///< of the next message
    std::vector<Event> events;                 ///< in order; channel: the out port
    std::vector<std::vector<Event>> feedback;  ///< [nodes] in order; channel: the edge
    ResultCollector results;
};

std::vector<unsigned char> to_bytes(const Snapshot& snapshot, const Wiring& wiring);

/// Throws Error (Exit::run_failed): not a snapshot, of another format, truncated, damaged, of another graph, of another
/// plugin version. Messages are checked like published ones.
Snapshot from_bytes(const std::vector<unsigned char>& bytes, const Wiring& wiring, MessagePool& pool);

}  // namespace pelorus::runtime
