/// Messages in words: to compare them and to say where they differ.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <pelorus/abi/message.h>

namespace pelorus::conformance {

/// `scan`, `tracks`, ...
const char* message_kind_name(std::uint32_t kind) noexcept;
/// `scan of sensor radar at 3 s (4 entries)`
std::string brief(const plr_message& message);

/// Each field with its value, exact to the last bit but for the payload of NaN; what the host sets (sequence, origin) left out.
using MessageWords = std::vector<std::pair<std::string, std::string>>;
MessageWords words_of(const plr_message& message);

/// Where two messages differ: `mean[2] of entry 1: 3.0 against 3.1`; "" where they do not.
std::string difference_of(const plr_message& one, const plr_message& other);

}  // namespace pelorus::conformance
