#include "graph/value.hpp"

#include <algorithm>
#include <utility>

#include "graph/problems.hpp"

namespace pelorus::graph {

const Value::Entry* Value::entry(const std::string& key) const noexcept {
    for (const Entry& candidate : map)
        if (candidate.key == key) return &candidate;
    return nullptr;
}

const Value* Value::find(const std::string& key) const noexcept {
    const Entry* found = entry(key);
    return found == nullptr ? nullptr : &found->value;
}

Value* Value::find(const std::string& key) noexcept {
    for (Entry& candidate : map)
        if (candidate.key == key) return &candidate.value;
    return nullptr;
}

Value& Value::set(const std::string& key, const Location& key_where, Value value) {
    kind = Kind::map;
    for (Entry& candidate : map) {
        if (candidate.key != key) continue;
        candidate.where = key_where;
        candidate.value = std::move(value);
        return candidate.value;
    }
    map.push_back({key, key_where, std::move(value)});
    return map.back().value;
}

bool Value::erase(const std::string& key) {
    const auto found = std::find_if(map.begin(), map.end(), [&](const Entry& entry) { return entry.key == key; });
    if (found == map.end()) return false;
    map.erase(found);
    return true;
}

std::vector<std::string> Value::keys() const {
    std::vector<std::string> names;
    for (const Entry& candidate : map) names.push_back(candidate.key);
    return names;
}

std::string Value::described() const {
    switch (kind) {
        case Kind::scalar:
            return "'" + scalar + "'";
        case Kind::list:
            return "a list";
        case Kind::map:
            return "a map";
        case Kind::null:
            break;
    }
    return "nothing";
}

void merge(Value& base, Value over) {
    if (!base.is_map() || !over.is_map()) {
        base = std::move(over);
        return;
    }
    for (Value::Entry& entry : over.map) {
        Value* below = base.find(entry.key);
        if (below != nullptr && entry.value.is_null())
            base.erase(entry.key);
        else if (below != nullptr && below->is_map() && entry.value.is_map())
            merge(*below, std::move(entry.value));
        else
            base.set(entry.key, entry.where, std::move(entry.value));
    }
    base.where = over.where;
    base.base = over.base;
}

Value mended(Value map, const std::vector<std::string>& known) {
    for (Value::Entry& entry : map.map) {
        if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
        const std::string right = meant(entry.key, known);
        if (!right.empty() && map.find(right) == nullptr) entry.key = right;
    }
    return map;
}

}  // namespace pelorus::graph
