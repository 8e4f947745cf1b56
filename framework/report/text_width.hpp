/// How wide a text stands on a terminal.
#pragma once

#include <algorithm>
#include <string>

namespace pelorus::report {

/// Columns in characters as a terminal shows them: bytes that continue a UTF-8 character take no place.
inline std::size_t text_width(const std::string& text) {
    return static_cast<std::size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

}  // namespace pelorus::report
