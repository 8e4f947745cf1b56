/// The `graph:` block as a tree of parts: addresses, and parts that are like others.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <pelorus/abi/describe.h>

#include "graph/value.hpp"

namespace pelorus::graph {

/// The description of the plugin of that id, or nullptr where there is no such plugin or it cannot be used.
using Descriptions = std::function<const plr_description*(const std::string& id)>;

/// Names of described parameters, slots and so on, in the order of the description.
std::vector<std::string> parameter_names(const plr_description& description);
std::vector<std::string> slot_names(const plr_description& description);
const plr_slot* find_slot(const plr_description& description, const std::string& name);

/// Whether a part (or what is known of it) stands in this slot without a name.
bool is_unnamed_part(const Value& slot);

/// The text under `use`, or "".
std::string plugin_of(const Value& part);

/// An address that leads nowhere, or a `like` that cannot be followed.
struct AddressError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class PartTree {
public:
    /// Both must outlive this object; the graph may change in between.
    PartTree(const Value& graph, const Descriptions& descriptions) : graph_(graph), descriptions_(descriptions) {}

    /// The part with its `like` followed: plugin, own parameters and parts of the other one (not what a slot wants to know of
    /// it), with the part's own `with` and `parts` laid over them. Throws AddressError.
    Value resolved(const Value& part, const std::string& address) const;

private:
    struct Found {
        Value part;
        std::string address;
    };
    using Chain = std::vector<std::string>;
    Value follow(const Value& part, const std::string& address, Chain& chain) const;
    Found find(const std::string& address, Chain& chain) const;

    const Value& graph_;
    const Descriptions& descriptions_;
};

}  // namespace pelorus::graph
