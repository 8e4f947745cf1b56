/// A config as a tree of values, each with its place in the file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/error.hpp"

namespace pelorus::graph {

/// A YAML value. Scalars keep their text and whether they were quoted; the reader decides what they mean.
struct Value {
    enum class Kind { null, scalar, list, map };
    Kind kind = Kind::null;
    bool quoted = false;
    std::string scalar;
    std::vector<Value> list;
    struct Entry;
    std::vector<Entry> map;  ///< in file order, keys unique
    Location where;          ///< of the value; of one that was given on the command line, the whole assignment (line 0)
    std::filesystem::path base;  ///< folder that relative paths in this value are relative to, absolute

    bool is_null() const noexcept { return kind == Kind::null; }
    bool is_scalar() const noexcept { return kind == Kind::scalar; }
    bool is_list() const noexcept { return kind == Kind::list; }
    bool is_map() const noexcept { return kind == Kind::map; }

    /// The value under a key of a map, or nullptr.
    const Value* find(const std::string& key) const noexcept;
    Value* find(const std::string& key) noexcept;
    const Entry* entry(const std::string& key) const noexcept;
    /// Gives a key of a map another value, or appends it.
    Value& set(const std::string& key, const Location& key_where, Value value);
    /// Whether there was such a key.
    bool erase(const std::string& key);
    std::vector<std::string> keys() const;

    /// As it is named in a message: `'3 m'`, `a list`, `a map`, `nothing`.
    std::string described() const;
};

struct Value::Entry {
    std::string key;
    Location where;  ///< of the key
    Value value;
};

/// Lays `over` on `base`: maps merge key by key, lists and scalars replace, and a key without value (`~`) takes the one below
/// away. A key that has nothing below it stays as it is.
void merge(Value& base, Value over);

/// A map in which misspelt keys have the names that were meant, unless those are taken: once a misspelling is told, what stands
/// under it is checked all the same.
Value mended(Value map, const std::vector<std::string>& known);

}  // namespace pelorus::graph
