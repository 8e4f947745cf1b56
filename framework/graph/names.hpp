/// Names that a config may give, and addresses made of them.
#pragma once

#include <string>
#include <vector>

namespace pelorus::graph {

/// A word of letters, digits and _ that does not begin with a digit.
bool is_name(const std::string& text);

/// Words that mean something in addresses and can therefore not be names of nodes or parts.
bool is_reserved(const std::string& name);

/// Why `name` cannot name a `what` ("node", "part", "frame"), or "".
std::string name_problem(const std::string& name, const std::string& what);

/// The segments between the dots; one empty segment for "".
std::vector<std::string> split_address(const std::string& address);

}  // namespace pelorus::graph
