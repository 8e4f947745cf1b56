/// Numbers and names as the wire spells them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace wire {

/// The shortest decimal that reads back as the same double; of -0 too. `value` must be finite.
void append_number(std::string& to, double value);
void append_number(std::string& to, std::int64_t value);
void append_number(std::string& to, std::uint64_t value);

/// Seconds as ns, rounded to the nearest; false beyond what 64 bits count.
bool nanoseconds(double seconds, std::int64_t& time) noexcept;

/// What came from outside, fit for a log: printable ASCII, at most `longest` bytes.
std::string shown(std::string_view text, std::size_t longest = 60);

/// 1 to 64 printable ASCII characters.
bool is_sender(std::string_view name) noexcept;

}  // namespace wire
