/// What ThreadSanitizer, where the runner is built with it, has seen in this process.
#pragma once

#include <string>

namespace pelorus::conformance::race_detector {

bool is_available() noexcept;
/// Races so far are none of our business.
void forget() noexcept;
/// `data race: written at <<...>>, read at <<...>>` (marks as of place_of), or "".
std::string first_race();

}  // namespace pelorus::conformance::race_detector
