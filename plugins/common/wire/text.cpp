#include "text.hpp"

#include <charconv>
#include <cmath>

#include "frame.hpp"

namespace wire {

namespace {

template <class Number> void append(std::string& to, Number value) {
    char text[32];
    to.append(text, std::to_chars(text, text + sizeof text, value).ptr);
}

bool printable(char c) noexcept { return c >= ' ' && c <= '~'; }

}  // namespace

void append_number(std::string& to, double value) {
    append(to, value);
    if (value == 0 && std::signbit(value)) to += ".0";  // JSON's -0 is an integer to many readers, and loses its sign
}
void append_number(std::string& to, std::int64_t value) { append(to, value); }
void append_number(std::string& to, std::uint64_t value) { append(to, value); }

bool nanoseconds(double seconds, std::int64_t& time) noexcept {
    if (!(std::abs(seconds) < 9.2e9)) return false;
    time = std::llround(seconds * 1e9);
    return true;
}

std::string shown(std::string_view text, std::size_t longest) {
    std::string out;
    for (const char c : text.substr(0, longest)) out += printable(c) ? c : '?';
    return text.size() > longest ? out + "..." : out;
}

bool is_sender(std::string_view name) noexcept {
    if (name.empty() || name.size() > longest_sender) return false;
    for (const char c : name)
        if (!printable(c)) return false;
    return true;
}

}  // namespace wire
