/// Sorting of cells and coordinates in linear time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

namespace partition {

/// What is sorted: by `row`, then `column`; elements that agree in both stay in their order.
struct Keyed {
    std::uint64_t row;
    std::uint32_t column;
    std::uint32_t point;
};

namespace detail {

constexpr unsigned most_digit_bits = 11;

/// One pass of a radix sort. Answers false, and moves nothing, where all elements have the same digit.
template <class Digit>
bool distribute(const Keyed* from, Keyed* to, std::size_t count, std::uint32_t digits, const Digit& digit) {
    std::uint32_t begin[std::size_t{1} << most_digit_bits];
    std::fill_n(begin, digits, 0u);
    for (std::size_t i = 0; i < count; ++i) ++begin[digit(from[i])];
    if (begin[digit(from[0])] == count) return false;
    std::uint32_t sum = 0;
    for (std::uint32_t k = 0; k < digits; ++k) sum += std::exchange(begin[k], sum);
    for (std::size_t i = 0; i < count; ++i) to[begin[digit(from[i])]++] = from[i];
    return true;
}

inline unsigned bits_of(std::uint64_t number) noexcept {
    unsigned bits = 0;
    for (; number != 0; number >>= 1) ++bits;
    return bits;
}

}  // namespace detail

/// Sorts `elements`, with `other` for as many; the result is where the answer points, in one of both. Keys are at most
/// `most_row` and `most_column`. Least digits first, O(count) for a fixed width of the keys.
inline Keyed* radix_sort(Keyed* elements, Keyed* other, std::size_t count, std::uint64_t most_row,
                         std::uint32_t most_column) {
    if (count < 2) return elements;
    const unsigned width = count < 4096 ? 8 : detail::most_digit_bits;
    const std::uint32_t digits = 1u << width, mask = digits - 1;
    for (unsigned shift = 0; shift < detail::bits_of(most_column); shift += width)
        if (detail::distribute(elements, other, count, digits,
                               [=](const Keyed& e) { return (e.column >> shift) & mask; }))
            std::swap(elements, other);
    for (unsigned shift = 0; shift < detail::bits_of(most_row); shift += width)
        if (detail::distribute(elements, other, count, digits,
                               [=](const Keyed& e) { return static_cast<std::uint32_t>(e.row >> shift) & mask; }))
            std::swap(elements, other);
    return elements;
}

/// A number whose order is that of the doubles (no NaN), and back.
inline std::uint64_t ordered_bits(double value) noexcept {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    return (bits >> 63) != 0 ? ~bits : bits | (std::uint64_t{1} << 63);
}

}  // namespace partition
