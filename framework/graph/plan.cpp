#include "graph/plan.hpp"

#include <algorithm>

#include "graph/names.hpp"
#include "host/description.hpp"
#include "host/kinds.hpp"

namespace pelorus::graph {

namespace {

using host::element;

// Parts that are like parts that are like parts can multiply; no real pipeline comes near these.
constexpr std::size_t most_parts = 10'000;
constexpr std::size_t deepest = 100;

const std::vector<std::string> node_keys{"use", "frame", "in", "with", "parts"};
const std::vector<std::string> part_keys{"use", "like", "with", "parts"};

/// A key without value: on the command line it takes away what stood there, in a file it is a mistake.
bool is_taken_away(const Value& value) { return value.is_null() && value.where.line == 0; }

class Planner {
public:
    Planner(const Value& graph, const PlanContext& context)
        : graph_(graph),
          context_(context),
          problems_(context.problems),
          descriptions_(context.plugins.descriptions()),
          tree_(graph_, descriptions_) {}

    std::vector<NodePlan> plan() {
        std::vector<NodePlan> nodes;
        for (const Value::Entry& entry : graph_.map) {
            const std::string problem = name_problem(entry.key, "node");
            if (!problem.empty())
                problems_.add(entry.where, problem);
            else
                nodes.push_back(plan_node(entry));
        }
        return nodes;
    }

    std::unique_ptr<PartPlan> plan_alone(const Value& part, const std::string& address) {
        is_alone_ = true;
        return is_part_map(part, address, part_keys, "part") ? plan_part(part, part.where, address) : nullptr;
    }

private:
    NodePlan plan_node(const Value::Entry& entry) {
        NodePlan node;
        node.name = entry.key;
        node.where = entry.where;
        if (!is_part_map(entry.value, entry.key, node_keys, "node")) return node;
        const Value written = mended(entry.value, node_keys);
        if (const Value* frame = written.find("frame")) {
            node.frame_where = frame->where;
            if (frame->is_scalar())
                node.frame = frame->scalar;
            else
                problems_.add(frame->where,
                              entry.key + ".frame: expected the name of a frame, got " + frame->described());
        }
        if (const Value* in = map_under(written, "in", entry.key)) node.in = *in;
        node.part = plan_part(written, entry.where, entry.key);
        return node;
    }

    bool is_part_map(const Value& value, const std::string& address, const std::vector<std::string>& keys,
                     const std::string& what) {
        if (!value.is_map()) {
            const std::string like = &keys == &part_keys ? like_hint(value, address) : std::string();
            problems_.add(value.where,
                          address + ": expected a map such as {use: PLUGIN}" + like + ", got " + value.described());
            return false;
        }
        for (const Value::Entry& entry : value.map) {
            if (std::find(keys.begin(), keys.end(), entry.key) != keys.end()) continue;
            problems_.add(entry.where,
                          address + ": unknown key '" + entry.key + "'" + hint(value, entry.key, keys, what));
        }
        return true;
    }

    /// ` or {like: world.sensors.radar}` where a text is the address of a part.
    std::string like_hint(const Value& text, const std::string& address) const {
        if (!text.is_scalar()) return {};
        Value part;
        part.kind = Value::Kind::map;
        part.set("like", text.where, text);
        try {
            tree_.resolved(part, address);
            return " or {like: " + text.scalar + "}";
        } catch (const AddressError&) {
            return {};
        }
    }

    /// Parameters and slots are often written one level too high.
    std::string hint(const Value& part, const std::string& key, const std::vector<std::string>& keys,
                     const std::string& what) {
        if (const plr_description* description = descriptions_(plugin_of(part))) {
            const std::vector<std::string> parameters = parameter_names(*description);
            if (std::find(parameters.begin(), parameters.end(), key) != parameters.end())
                return "; parameters stand under `with`";
            if (find_slot(*description, key) != nullptr) return "; slots stand under `parts`";
        }
        return suggestion(key, keys, "keys of a " + what);
    }

    const Value* map_under(const Value& part, const std::string& key, const std::string& address) {
        const Value* value = part.find(key);
        if (value == nullptr || is_taken_away(*value)) return nullptr;
        if (value->is_map()) return value;
        const std::string like = key == "in" ? " such as {PORT: NODE.PORT}" : "";
        problems_.add(value->where, address + "." + key + ": expected a map" + like + ", got " + value->described());
        return nullptr;
    }

    /// `where` is the place of the part's name.
    std::unique_ptr<PartPlan> plan_part(const Value& written, const Location& where, const std::string& address,
                                        const plr_slot* place = nullptr, const std::string& name = {}) {
        Value value;
        try {
            value = tree_.resolved(written, address);
        } catch (const AddressError& error) {
            problems_.add(written.entry("like")->value.where, address + ": " + error.what());
            return nullptr;
        }
        const Value* use = value.find("use");
        if (use == nullptr || !use->is_scalar() || use->scalar.empty()) {
            problems_.add(use == nullptr ? where : use->where, address + ": names no plugin (use: KIND.NAME)");
            return nullptr;
        }
        const Plugins::Found& found = context_.plugins.find(use->scalar);
        if (found.plugin == nullptr) problems_.add(use->where, address + ": " + found.error);
        const host::LoadedPlugin* const plugin = found.plugin != nullptr ? found.plugin : found.meant;
        if (plugin == nullptr) return nullptr;
        auto part = std::make_unique<PartPlan>();
        part->address = address;
        part->name = name;
        part->where = where;
        part->use_where = use->where;
        part->plugin = plugin;
        part->place = place;
        if (place != nullptr) part->slot = place->name;
        if (!is_right_kind(*part, found.plugin != nullptr)) return nullptr;
        part->with.kind = Value::Kind::map;
        if (const Value* with = map_under(value, "with", address)) part->with = *with;
        read_values(*part);
        const Value* parts = map_under(value, "parts", address);
        fill_slots(*part, parts == nullptr ? Value() : mended(*parts, slot_names(part->description())), parts);
        return part;
    }

    /// A plugin that was only guessed is not told of.
    bool is_right_kind(const PartPlan& part, bool is_told) {
        const std::string kind = part.description().kind, id = part.description().id;
        if (part.place != nullptr) {
            if (kind == part.place->kind) return true;
            if (!is_told) return false;
            problems_.add(part.use_where, part.address + ": " + id + " is " + with_article(kind) + "; slot " +
                                              part.slot + " takes " + with_article(part.place->kind));
            return false;
        }
        const host::Kind* known = host::find_kind(kind);
        if (is_alone_ || (known != nullptr && known->is_stage)) return true;
        if (!is_told) return false;
        std::vector<std::string> stages;
        for (const host::Kind& each : host::kinds)
            if (each.is_stage) stages.emplace_back(each.name);
        problems_.add(part.use_where,
                      part.address + ": " + id + " is " + with_article(kind) + "; a node is one of " + join(stages));
        return false;
    }

    void read_values(PartPlan& part) {
        const plr_description& description = part.description();
        std::vector<std::string> names = parameter_names(description);
        if (part.place != nullptr) {
            for (std::uint32_t i = 0; i < part.place->parameter_count; ++i) {
                const std::string name = element(part.place->parameters, i).name;
                if (std::find(names.begin(), names.end(), name) != names.end())
                    problems_.add(part.use_where, part.address + ": the slot '" + part.slot + "' and " +
                                                      description.id + " both have a parameter '" + name + "'");
                else
                    names.push_back(name);
            }
        }
        const std::vector<std::string>& keys = part.place == nullptr ? node_keys : part_keys;
        for (const Value::Entry& entry : part.with.map) {
            if (std::find(names.begin(), names.end(), entry.key) != names.end()) continue;
            const bool is_key = std::find(keys.begin(), keys.end(), entry.key) != keys.end();
            problems_.add(entry.where, part.address + ": " + description.id + " has no parameter '" + entry.key + "'" +
                                           (is_key ? "; `" + entry.key + "` stands beside `with`, not under it"
                                                   : suggestion(entry.key, names, "parameters")));
        }
        part.with = mended(part.with, names);
        const ParameterContext context{problems_,      part.address,  description.id,
                                       part.use_where, context_.base, context_.variables};
        part.values = read_parameters(description.parameters, description.parameter_count, part.with, context);
        if (part.place != nullptr)
            part.slot_values = read_parameters(part.place->parameters, part.place->parameter_count, part.with, context);
    }

    /// `written`: the slots as the file has them, or nullptr.
    void fill_slots(PartPlan& holder, const Value& parts, const Value* written) {
        const plr_description& description = holder.description();
        for (const Value::Entry& entry : written == nullptr ? std::vector<Value::Entry>() : written->map)
            if (find_slot(description, entry.key) == nullptr)
                problems_.add(entry.where, holder.address + ": " + description.id + " has no slot '" + entry.key + "'" +
                                               suggestion(entry.key, slot_names(description), "slots"));
        for (std::uint32_t i = 0; i < description.slot_count; ++i) {
            const plr_slot& slot = element(description.slots, i);
            const Value::Entry* content = parts.entry(slot.name);
            const std::size_t count = content == nullptr ? 0 : fill_slot(holder, slot, *content);
            check_count(holder, slot, count, content == nullptr ? holder.use_where : content->where);
        }
    }

    void check_count(const PartPlan& holder, const plr_slot& slot, std::size_t count, const Location& where) {
        const auto given = static_cast<std::int64_t>(count);
        if (given >= slot.min && (slot.max < 0 || given <= slot.max)) return;
        std::string wanted =
            given < slot.min ? "at least " + std::to_string(slot.min) : "at most " + std::to_string(slot.max);
        if (slot.min == slot.max) wanted = std::to_string(slot.min);
        problems_.add(where, holder.address + ": the slot '" + slot.name + "' takes " + wanted + " (kind " + slot.kind +
                                 "), got " + std::to_string(count));
    }

    /// How many parts the config puts there, whether they are good or not.
    std::size_t fill_slot(PartPlan& holder, const plr_slot& slot, const Value::Entry& content) {
        const std::string address = holder.address + "." + slot.name;
        if (is_taken_away(content.value)) return 0;
        holder.slots.emplace_back(slot.name, content.where);
        if (!content.value.is_map()) {
            problems_.add(content.value.where, address + ": expected a map such as {use: PLUGIN}" +
                                                   like_hint(content.value, address) +
                                                   ", or from names to such maps, got " + content.value.described());
            return static_cast<std::size_t>(std::max(slot.min, 1));
        }
        if (is_unnamed_part(content.value)) {
            add_part(holder, slot, content, address, {});
            return 1;
        }
        std::size_t count = 0;
        for (const Value::Entry& entry : content.value.map) {
            if (is_taken_away(entry.value)) continue;
            ++count;
            const std::string problem = name_problem(entry.key, "part");
            if (problem.empty())
                add_part(holder, slot, entry, address + "." + entry.key, entry.key);
            else
                problems_.add(entry.where, address + ": " + problem);
        }
        return count;
    }

    void add_part(PartPlan& holder, const plr_slot& slot, const Value::Entry& entry, const std::string& address,
                  const std::string& name) {
        if (++parts_ == most_parts || depth_ >= deepest)
            problems_.add(entry.where, address + ": more than " +
                                           (depth_ >= deepest ? std::to_string(deepest) + " levels of"
                                                              : std::to_string(most_parts)) +
                                           " parts");
        if (parts_ >= most_parts || depth_ >= deepest) return;
        if (!is_part_map(entry.value, address, part_keys, "part")) return;
        ++depth_;
        std::unique_ptr<PartPlan> part = plan_part(mended(entry.value, part_keys), entry.where, address, &slot, name);
        --depth_;
        if (part != nullptr) holder.parts.push_back(std::move(part));
    }

    const Value& graph_;
    const PlanContext& context_;
    Problems& problems_;
    const Descriptions descriptions_;
    const PartTree tree_;
    std::size_t parts_ = 0, depth_ = 0;
    bool is_alone_ = false;  // no node, although in no slot
};

/// `legs[2].duration` -> legs, 2, duration
std::vector<std::string> steps(const std::string& where) {
    std::vector<std::string> found(1);
    for (const char c : where) {
        if (c == '.' || c == '[')
            found.emplace_back();
        else if (c != ']')
            found.back() += c;
    }
    return found;
}

Location place_in(const Value& value, const std::vector<std::string>& path, std::size_t at) {
    if (at >= path.size()) return value.where;
    if (value.is_map()) {
        const Value* below = value.find(path[at]);
        return below == nullptr ? value.where : place_in(*below, path, at + 1);
    }
    const bool is_index =
        !path[at].empty() && path[at].size() < 9 && path[at].find_first_not_of("0123456789") == std::string::npos;
    if (value.is_list() && is_index) {
        const std::size_t index = std::stoul(path[at]);
        if (index < value.list.size()) return place_in(value.list[index], path, at + 1);
    }
    return value.where;
}

Location place_below(const PartPlan& part, const std::vector<std::string>& path, std::size_t at) {
    if (at >= path.size()) return part.where;
    if (const Value* value = part.with.find(path[at])) return place_in(*value, path, at + 1);
    for (const std::unique_ptr<PartPlan>& below : part.parts) {
        if (below->slot != path[at]) continue;
        if (below->name.empty()) return place_below(*below, path, at + 1);
        if (at + 1 < path.size() && below->name == path[at + 1]) return place_below(*below, path, at + 2);
    }
    for (const auto& [slot, where] : part.slots)
        if (slot == path[at]) return where;
    return part.where;
}

}  // namespace

std::vector<NodePlan> plan_graph(const Value& graph, const PlanContext& context) {
    return Planner(graph, context).plan();
}

std::unique_ptr<PartPlan> plan_part(const Value& part, const std::string& address, const PlanContext& context) {
    Value nothing;
    nothing.kind = Value::Kind::map;
    return Planner(nothing, context).plan_alone(part, address);
}

Location place_of(const PartPlan& part, const std::string& where) { return place_below(part, steps(where), 0); }

}  // namespace pelorus::graph
