/// Philox-4x32-10, the counter-based generator of Salmon, Moraes, Dror and Shaw: Parallel Random Numbers: As Easy as 1, 2, 3
/// (SC 2011). For each key a bijection of 128-bit counters whose outputs pass for random.
#pragma once

#include <array>
#include <cstdint>

namespace pelorus::host {

using PhiloxBlock = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

/// The block of that counter under that key. Words as in the authors' reference implementation (least significant first).
constexpr PhiloxBlock philox(PhiloxBlock counter, PhiloxKey key) noexcept {
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t product0 = std::uint64_t{0xD2511F53u} * counter[0];
        const std::uint64_t product1 = std::uint64_t{0xCD9E8D57u} * counter[2];
        counter = {
            static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(product1),
            static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(product0)};
        key = {key[0] + 0x9E3779B9u, key[1] + 0xBB67AE85u};
    }
    return counter;
}

}  // namespace pelorus::host
