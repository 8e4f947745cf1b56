#include "graph/part_tree.hpp"

#include <algorithm>
#include <utility>

#include "graph/names.hpp"
#include "graph/problems.hpp"
#include "host/description.hpp"

namespace pelorus::graph {

std::vector<std::string> parameter_names(const plr_description& description) {
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < description.parameter_count; ++i)
        names.emplace_back(host::element(description.parameters, i).name);
    return names;
}

std::vector<std::string> slot_names(const plr_description& description) {
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < description.slot_count; ++i)
        names.emplace_back(host::element(description.slots, i).name);
    return names;
}

const plr_slot* find_slot(const plr_description& description, const std::string& name) {
    for (std::uint32_t i = 0; i < description.slot_count; ++i) {
        const plr_slot& slot = host::element(description.slots, i);
        if (name == slot.name) return &slot;
    }
    return nullptr;
}

bool is_unnamed_part(const Value& slot) {
    return slot.is_map() && std::any_of(slot.map.begin(), slot.map.end(), [](const Value::Entry& entry) {
               return entry.key == "use" || entry.key == "like" || entry.key == "with" || entry.key == "parts";
           });
}

std::string plugin_of(const Value& part) {
    const Value* use = part.find("use");
    return use != nullptr && use->is_scalar() ? use->scalar : std::string();
}

Value PartTree::resolved(const Value& part, const std::string& address) const {
    Chain chain;
    return follow(part, address, chain);
}

Value PartTree::follow(const Value& part, const std::string& address, Chain& chain) const {
    const Value::Entry* like = part.entry("like");
    if (like == nullptr) return part;
    if (!like->value.is_scalar())
        throw AddressError("like: expected the address of a part, got " + like->value.described());
    if (part.find("use") != nullptr) throw AddressError("give `use` or `like`, not both");
    const std::string& target = like->value.scalar;
    const auto seen = std::find(chain.begin(), chain.end(), target);
    if (seen != chain.end()) {
        std::vector<std::string> circle(seen, chain.end());
        circle.push_back(target);
        throw AddressError("parts are like each other in a circle: " + join(circle, " -> "));
    }
    if (address == target || address.compare(0, target.size() + 1, target + ".") == 0)
        throw AddressError("'" + address + "' cannot be like '" + target + "', which " +
                           (address == target ? "is itself" : "holds it"));
    chain.push_back(target);
    const Found found = find(target, chain);
    Value result = follow(found.part, found.address, chain);
    chain.pop_back();

    const plr_description* description = descriptions_(plugin_of(result));
    if (Value* with = result.find("with")) {
        const std::vector<std::string> own =
            description != nullptr ? parameter_names(*description) : std::vector<std::string>();
        with->map.erase(std::remove_if(with->map.begin(), with->map.end(),
                                       [&](const Value::Entry& entry) {
                                           return std::find(own.begin(), own.end(), entry.key) == own.end();
                                       }),
                        with->map.end());
    }
    if (Value* use = result.find("use")) use->where = like->value.where;
    Value over = part;
    over.erase("like");
    merge(result, std::move(over));
    return result;
}

PartTree::Found PartTree::find(const std::string& address, Chain& chain) const {
    const std::vector<std::string> segments = split_address(address);
    const std::string prefix = "'" + address + "' leads nowhere: ";
    const Value* node = graph_.find(segments.front());
    if (node == nullptr)
        throw AddressError(prefix + "there is no node '" + segments.front() + "'" +
                           suggestion(segments.front(), graph_.keys(), "nodes"));
    if (segments.size() == 1) throw AddressError("'" + address + "' is a node, expected the address of a part");
    Found found{*node, segments.front()};
    for (std::size_t i = 1; i < segments.size();) {
        const Value holder = follow(found.part, found.address, chain);
        const Value* parts = holder.find("parts");
        const Value* slot = parts == nullptr ? nullptr : parts->find(segments[i]);
        if (slot == nullptr)
            throw AddressError(
                prefix + found.address + " has no part in a slot '" + segments[i] + "'" +
                suggestion(segments[i], parts == nullptr ? std::vector<std::string>() : parts->keys(), "parts"));
        found.address += "." + segments[i++];
        if (is_unnamed_part(*slot)) {
            found.part = *slot;
            continue;
        }
        if (i == segments.size())
            throw AddressError("'" + address +
                               "' is a slot, expected the address of a part in it: " + join(slot->keys()));
        const Value* part = slot->find(segments[i]);
        if (part == nullptr)
            throw AddressError(prefix + "there is no part '" + segments[i] + "' in " + found.address +
                               suggestion(segments[i], slot->keys(), "parts"));
        found.address += "." + segments[i++];
        found.part = *part;
    }
    return found;
}

}  // namespace pelorus::graph
