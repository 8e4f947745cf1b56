#include "graph/overrides.hpp"

#include <algorithm>
#include <utility>

#include "graph/names.hpp"

namespace pelorus::graph {

namespace {

Value empty_map(const Assignment& assignment) {
    Value map;
    map.kind = Value::Kind::map;
    map.where = assignment.where;
    map.base = assignment.value.base;
    return map;
}

/// `.sensors.radar` for the slot or part `radar` somewhere below a part, "" if there is none.
std::string way_to(const Value& part, const std::string& name) {
    const Value* parts = part.find("parts");
    if (parts == nullptr) return {};
    for (const Value::Entry& slot : parts->map) {
        if (slot.key == name) return "." + name;
        if (is_unnamed_part(slot.value)) {
            const std::string below = way_to(slot.value, name);
            if (!below.empty()) return "." + slot.key + below;
            continue;
        }
        for (const Value::Entry& named : slot.value.map) {
            const std::string below = named.key == name ? std::string() : way_to(named.value, name);
            if (named.key == name || !below.empty()) return "." + slot.key + "." + named.key + below;
        }
    }
    return {};
}

/// One assignment on its way down the tree. Throws AddressError.
class Walk {
public:
    Walk(Value& root, const Assignment& assignment, const Descriptions& descriptions)
        : root_(root),
          assignment_(assignment),
          value_(assignment.value),
          segments_(split_address(assignment.address)),
          descriptions_(descriptions) {}

    void apply() {
        if (std::find(segments_.begin(), segments_.end(), "") != segments_.end())
            throw AddressError("'" + assignment_.address +
                               "' is not an address: node, slot, part, parameter, joined by dots");
        if (segments_.front() == "run") return set_run();
        Value* graph = root_.find("graph");
        if (graph == nullptr || !graph->is_map()) throw AddressError("the config has no graph that it could change");
        graph_ = graph;
        const std::string& name = segments_.front();
        Value* node = graph->find(name);
        if (segments_.size() == 1) return replace(*graph, name, node != nullptr, "node", graph->keys());
        if (node == nullptr)
            throw AddressError("there is no node '" + name + "'" + suggestion(name, graph->keys(), "nodes"));
        if (!node->is_map()) throw AddressError("node '" + name + "' is not a map");
        at_ = 1;
        into_part(*node, true);
    }

private:
    bool at_last() const { return at_ + 1 == segments_.size(); }
    const std::string& here() const { return segments_[at_]; }
    std::string address_so_far() const {
        return join({segments_.begin(), segments_.begin() + static_cast<std::ptrdiff_t>(at_)}, ".");
    }

    void put(Value& map, const std::string& key) { map.set(key, assignment_.where, value_); }
    Value& child(Value& map, const std::string& key) {
        Value* below = map.find(key);
        return below != nullptr && below->is_map() ? *below : map.set(key, assignment_.where, empty_map(assignment_));
    }

    void set_run() {
        if (segments_.size() != 2) throw AddressError("expected run.seed, got '" + assignment_.address + "'");
        Value& run = child(root_, "run");
        if (value_.is_null())
            run.erase(segments_[1]);
        else
            put(run, segments_[1]);
    }

    /// Gives a node or a named part a new map, or takes it away.
    void replace(Value& map, const std::string& name, bool is_there, const std::string& what,
                 const std::vector<std::string>& others) {
        if (value_.is_map()) return put(map, name);
        if (!is_there)
            throw AddressError("there is no " + what + " '" + name + "'" + suggestion(name, others, what + "s"));
        if (value_.is_null())
            remove(map, name);
        else
            throw AddressError("'" + assignment_.address + "' is a " + what +
                               ": expected a map such as {use: PLUGIN}, or ~ to remove it, got " + value_.described());
    }

    /// Below a part that is like another one, taking away must be said: what the other one has would show through.
    void remove(Value& map, const std::string& key) {
        if (below_like_)
            put(map, key);
        else
            map.erase(key);
    }

    void into_part(Value& part, bool is_node) {
        const std::string& key = here();
        if (at_last() && (key == "use" || (is_node && key == "frame") || (!is_node && key == "like"))) {
            if (value_.is_null())
                part.erase(key);
            else
                put(part, key);
            return;
        }
        if (is_node && key == "in") return set_edge(part);
        below_like_ = below_like_ || part.find("like") != nullptr;
        const Value effective = with_like_followed(part);
        const plr_description* description = descriptions_(plugin_of(effective));
        const Value* parts = effective.find("parts");
        const bool is_slot = description != nullptr
                                 ? find_slot(*description, key) != nullptr
                                 : (parts != nullptr && parts->find(key) != nullptr) || !at_last() || value_.is_map();
        if (is_slot) return into_slot(part, effective);
        if (description != nullptr && (!at_last() || value_.is_map())) refuse_slot(*description, effective);
        Value& with = child(part, "with");
        if (value_.is_null() && !below_like_ && with.find(key) != nullptr)
            with.erase(key);
        else
            put(with, key);
    }

    /// A `like` that leads nowhere is told by the check of the config.
    Value with_like_followed(const Value& part) const {
        try {
            return PartTree(*graph_, descriptions_).resolved(part, address_so_far());
        } catch (const AddressError&) {
            return part;
        }
    }

    [[noreturn]] void refuse_slot(const plr_description& description, const Value& part) const {
        const std::vector<std::string> parameters = parameter_names(description);
        if (std::find(parameters.begin(), parameters.end(), here()) != parameters.end())
            throw AddressError("'" + here() + "' is a parameter of " + description.id + ": " +
                               (at_last() ? "a map is no value for it" : "nothing stands below it"));
        const std::string way = way_to(part, here());
        if (!way.empty()) {
            const std::vector<std::string> rest(segments_.begin() + static_cast<std::ptrdiff_t>(at_) + 1,
                                                segments_.end());
            throw AddressError(std::string(description.id) + " has no slot '" + here() + "'; did you mean '" +
                               address_so_far() + way + (rest.empty() ? "" : "." + join(rest, ".")) + "'?");
        }
        throw AddressError(std::string(description.id) + " has no slot '" + here() + "'" +
                           suggestion(here(), slot_names(description), "slots"));
    }

    void set_edge(Value& node) {
        if (at_last()) {
            if (value_.is_map()) return put(node, "in");
            if (value_.is_null()) return static_cast<void>(node.erase("in"));
            throw AddressError("'" + assignment_.address + "': expected a map from port to node.port, got " +
                               value_.described());
        }
        if (segments_.size() != 3)
            throw AddressError("'" + assignment_.address + "' is not an address: expected NODE.in.PORT");
        Value& in = child(node, "in");
        if (!value_.is_null())
            put(in, segments_[2]);
        else if (!in.erase(segments_[2]))
            throw AddressError("nothing is connected to '" + segments_[2] + "'" +
                               suggestion(segments_[2], in.keys(), "ports"));
    }

    /// `part` is what stands in the file, `effective` the same with `like` followed; the slot is here().
    void into_slot(Value& part, const Value& effective) {
        const std::string slot = here();
        const Value* shown_parts = effective.find("parts");
        const Value* shown = shown_parts == nullptr ? nullptr : shown_parts->find(slot);
        if (at_last()) {
            if (value_.is_map()) return put(child(part, "parts"), slot);
            if (!value_.is_null())
                throw AddressError("'" + assignment_.address +
                                   "' is a slot: expected a map such as {use: PLUGIN}, or ~ to empty it, got " +
                                   value_.described());
            if (shown != nullptr) remove(child(part, "parts"), slot);
            return;
        }
        ++at_;
        const bool is_empty = shown == nullptr || shown->map.empty();
        const bool is_unnamed = is_empty ? here() == "use" || here() == "like" : is_unnamed_part(*shown);
        Value& content = child(child(part, "parts"), slot);
        if (is_unnamed) return into_part(content, false);
        const std::vector<std::string> names = is_empty ? std::vector<std::string>() : shown->keys();
        const std::string name = here();
        const bool is_there = std::find(names.begin(), names.end(), name) != names.end();
        if (at_last()) return replace(content, name, is_there, "part", names);
        ++at_;
        if (!is_there && !(at_last() && (here() == "use" || here() == "like"))) refuse_part(slot, name, names);
        into_part(child(content, name), false);
    }

    [[noreturn]] void refuse_part(const std::string& slot, const std::string& name,
                                  const std::vector<std::string>& names) const {
        if (names.empty()) throw AddressError("the slot '" + slot + "' is empty");
        throw AddressError("there is no part '" + name + "' in the slot '" + slot + "'" +
                           suggestion(name, names, "parts"));
    }

    Value& root_;
    Value* graph_ = nullptr;
    const Assignment& assignment_;
    const Value& value_;
    const std::vector<std::string> segments_;
    const Descriptions& descriptions_;
    std::size_t at_ = 0;
    bool below_like_ = false;
};

}  // namespace

namespace {

/// A hint at the address without the words that stand in the file but not in addresses.
std::string shorter(const std::string& address) {
    std::vector<std::string> segments = split_address(address);
    const std::size_t before = segments.size();
    if (segments.front() == "graph") segments.erase(segments.begin());
    segments.erase(std::remove_if(segments.begin(), segments.end(),
                                  [](const std::string& word) { return word == "with" || word == "parts"; }),
                   segments.end());
    if (segments.size() == before || segments.empty()) return {};
    return "; addresses leave `graph`, `with` and `parts` away: " + join(segments, ".");
}

}  // namespace

void apply_overrides(Value& root, const std::vector<Assignment>& assignments, const Descriptions& descriptions,
                     Problems& problems) {
    for (const Assignment& assignment : assignments) {
        Value changed = root;
        try {
            Walk(changed, assignment, descriptions).apply();
            root = std::move(changed);
        } catch (const AddressError& error) {
            problems.add(assignment.where, error.what() + shorter(assignment.address));
        }
    }
}

}  // namespace pelorus::graph
