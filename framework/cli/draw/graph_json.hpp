/// A graph as data: `check --json`, `inspect CONFIG --json`, and what its drawings are made from.
#pragma once

#include <nlohmann/json.hpp>

#include "graph/graph.hpp"

namespace pelorus::cli {

/// `title`, `seed`, `nodes` (name, use, kind, frame, and as part_json() `with` and `parts`), `edges` (from, to, message, feedback,
/// streams with sensor, frame and space) and `plugins` (id, version, library). docs/command.md has the whole.
nlohmann::ordered_json graph_json(const graph::Graph& graph);

}  // namespace pelorus::cli
