/// Parameters of a plugin or a slot: from the config's text to plr_value, by the description (ABI describe.h).
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <pelorus/abi/describe.h>

#include "graph/problems.hpp"
#include "graph/value.hpp"

namespace pelorus::graph {

/// Value of a variable that a path may name (`${PELORUS_DATA}`), or nothing where it is not set.
using Variables = std::function<std::optional<std::string>(const std::string& name)>;

/// One value with the memory that its pointers lead to.
struct StoredValue {
    plr_value value{};
    std::string text;
    std::vector<double> numbers;
    std::deque<std::string> words;   ///< text cells of a table
    std::vector<const char*> texts;  ///< [rows * columns]
};

/// Values in the order of the description. May be moved: what plr_value points to stays where it is.
class ParameterSet {
public:
    ParameterSet() = default;
    ParameterSet(ParameterSet&&) noexcept = default;
    ParameterSet& operator=(ParameterSet&&) noexcept = default;

    const plr_value* data() const noexcept { return values_.data(); }
    std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(values_.size()); }
    const plr_value& operator[](std::uint32_t index) const noexcept { return values_[index]; }

    StoredValue& append() { return stored_.emplace_back(); }
    /// Once, when all values have been appended.
    void complete();

private:
    std::deque<StoredValue> stored_;
    std::vector<plr_value> values_;
};

struct ParameterContext {
    Problems& problems;
    std::string address;         ///< of the part, for messages
    std::string plugin;          ///< whose parameters they are, for messages about defaults
    Location where;              ///< of the part, for parameters that are missing
    std::filesystem::path base;  ///< for default paths
    Variables variables;
};

/// Reads the values that `with` gives for `count` described parameters and the defaults of the others. Keys of `with` that are
/// not described here are none of its business. A key without value (`~`) from the command line means the default. What is
/// wrong goes to context.problems; the answer is then incomplete.
ParameterSet read_parameters(const plr_parameter* first, std::uint32_t count, const Value& with,
                             const ParameterContext& context);

/// The values as a config would give them, in SI without units. Optional ones that were not given are left out.
nlohmann::ordered_json parameters_json(const plr_parameter* first, const ParameterSet& values);

}  // namespace pelorus::graph
