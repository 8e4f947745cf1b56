/// The flags of `pelorus conform`, which pelorus-conform reads again.
#pragma once

#include "cli/command_line.hpp"

namespace pelorus::cli {

const Grammar& conform_grammar();

}  // namespace pelorus::cli
