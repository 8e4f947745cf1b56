/// YAML text to a tree of values.
#pragma once

#include <filesystem>
#include <string>

#include "graph/problems.hpp"
#include "graph/value.hpp"

namespace pelorus::graph {

/// Where a text came from.
struct TextOrigin {
    Location where;              ///< line 0: text that is not in a file; all its values then have this very place
    std::string file;            ///< name of the file in messages, if `where` is not used
    std::filesystem::path base;  ///< see Value::base
};

/// Reads one YAML document: aliases are resolved, `<<` is merged (a map or a list of maps; explicit keys win, then the
/// earlier map). Refused: duplicate keys, keys that are not words, tags, several documents, more than 200 levels or a million
/// values. Empty text is a null value. Throws ConfigError.
Value read_yaml(const std::string& text, const TextOrigin& origin);

}  // namespace pelorus::graph
