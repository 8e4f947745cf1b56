/// Pieces of configs that the documentation shows, put where they belong.
#pragma once

#include <string>

namespace pelorus::test {

/// The config with the keys of `fragment` at `address`: "" is `graph`, `tracker.estimator` the slots of that part, `/` the top level. What
/// stood under those keys is replaced whole, `~` takes it away. Throws std::runtime_error for an address that is not there.
std::string merge_fragment(const std::string& config, const std::string& address, const std::string& fragment);

}  // namespace pelorus::test
