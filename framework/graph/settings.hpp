/// What a config says beside its graph and its frames.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "graph/problems.hpp"
#include "graph/value.hpp"

namespace pelorus::graph {

struct Settings {
    std::string title;
    std::optional<std::uint64_t> seed;
};

/// Checks the keys of the whole config (`pelorus`, `title`, `run`, `frames`, `graph`, `campaign`; keys that begin with `x-` are
/// free for anchors), the version, and the structure of `campaign:`.
Settings read_settings(const Value& root, Problems& problems);

}  // namespace pelorus::graph
