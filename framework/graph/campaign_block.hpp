/// The `campaign:` block of a config: many runs of it, over a grid of values and over variants.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graph/document.hpp"
#include "graph/problems.hpp"
#include "graph/value.hpp"

namespace pelorus::graph {

/// One dimension of the grid. Its addresses take their values together, the k-th of each at the k-th point.
struct Axis {
    struct Series {
        std::string address;
        Location where;  ///< of the address
        std::vector<Value> values;
    };
    std::string name;            ///< the address, or the name that several go by
    std::vector<Series> series;  ///< at least one; all of one length
    std::size_t size() const { return series.front().values.size(); }
};

/// A named set of overrides.
struct Variant {
    std::string name;
    std::vector<Assignment> overrides;
};

struct CampaignBlock {
    std::uint64_t runs = 1;
    std::vector<Axis> axes;         ///< in file order
    std::vector<Variant> variants;  ///< in file order
    std::string reference;  ///< the variant that the others are compared with: the first unless named; "" : no variants
    bool goes_on = false;   ///< on_failure: a failed run is counted, and the campaign goes on
};

/// An override from a config. `~` takes away, as on the command line: unlike a key that was left without a value by mistake.
Assignment override_of(const std::string& address, const Location& where, Value value);

/// Reads the block; nullptr: there is none. What is wrong with its structure goes to `problems`; whether the addresses lead
/// anywhere and the values are good is left to the check of each cell's config.
CampaignBlock read_campaign(const Value* block, Problems& problems);

}  // namespace pelorus::graph
