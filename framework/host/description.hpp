/// What a plugin says of itself (ABI describe.h): read at any minor version, and checked before anybody relies on it.
#pragma once

#include <cstdint>
#include <string>

#include <pelorus/abi/describe.h>

namespace pelorus::host {

/// Element `index` of an array whose structs may be longer than this host knows: stepped by the first one's struct_size.
template <class Element> const Element& element(const Element* first, std::uint32_t index) noexcept {
    const auto* bytes = reinterpret_cast<const unsigned char*>(first);
    return *reinterpret_cast<const Element*>(bytes + static_cast<std::uint64_t>(index) * first->struct_size);
}

/// What is structurally wrong with the description, as one line, or "". Checked are presence of strings and arrays, struct
/// sizes, names (form, doubles, words that a config uses itself), types, choices, bounds, sizes, kinds of slots and ports, and
/// that every parameter has a default unless it is required or optional; not whether a default's text can be read.
std::string description_problem(const plr_description& description);

}  // namespace pelorus::host
