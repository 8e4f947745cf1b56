/// A graph for people, from what graph_json() tells.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace pelorus::cli {

/// A few words for a stream: `radar: position.x,y,z [m], in frame 'mast'`.
std::string stream_text(const nlohmann::ordered_json& stream);

/// A block a node: its values, its parts as an indented tree, the edges that end there and those that begin there.
std::string graph_text(const nlohmann::ordered_json& graph);

/// The Graphviz language: a table a node, with one a part inside; feedback edges are dashed.
std::string graph_dot(const nlohmann::ordered_json& graph);

}  // namespace pelorus::cli
