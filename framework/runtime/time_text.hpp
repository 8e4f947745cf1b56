/// Times for people.
#pragma once

#include <cstdint>
#include <string>

namespace pelorus::runtime {

/// Nanoseconds as seconds with all nine decimals: `12.000000000 s`.
std::string seconds_text(std::int64_t nanoseconds);

}  // namespace pelorus::runtime
