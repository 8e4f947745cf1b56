#include <algorithm>
#include <cmath>

#include "host/philox.hpp"
#include "host/services.hpp"

namespace pelorus::host {

namespace {

constexpr double two_pi = 6.283185307179586476925286766559;

struct Pair {
    std::uint64_t word[2];
};

/// Philox on 64-bit words: key, and counter {low half, high half}.
constexpr Pair philox64(std::uint64_t key, std::uint64_t low, std::uint64_t high) noexcept {
    const auto lower = [](std::uint64_t word) { return static_cast<std::uint32_t>(word); };
    const auto upper = [](std::uint64_t word) { return static_cast<std::uint32_t>(word >> 32); };
    const PhiloxBlock block = philox({lower(low), upper(low), lower(high), upper(high)}, {lower(key), upper(key)});
    const auto join = [](std::uint32_t low_word, std::uint32_t high_word) {
        return std::uint64_t{high_word} << 32 | low_word;
    };
    return {{join(block[0], block[1]), join(block[2], block[3])}};
}

/// Mixes a word into a key: the key is the counter, the word the Philox key, so that for equal words different keys stay
/// different (a bijection), and different words permute all keys in unrelated ways.
constexpr plr_key absorb(plr_key key, std::uint64_t word) noexcept {
    const Pair mixed = philox64(word, key.word[0], key.word[1]);
    return {{mixed.word[0], mixed.word[1]}};
}

/// An odd multiple of 2^-53: 52 random bits, in (0, 1) with neither end, symmetric about 1/2, every value exact.
constexpr double open_unit(std::uint64_t bits) noexcept { return static_cast<double>((bits >> 11) | 1u) * 0x1p-53; }

/// Block `index` of a key holds its numbers 2 index and 2 index + 1.
struct TwoNumbers {
    double value[2];
};

TwoNumbers uniform_block(plr_key key, std::uint64_t index) noexcept {
    const Pair bits = philox64(key.word[0], index, key.word[1]);
    return {{open_unit(bits.word[0]), open_unit(bits.word[1])}};
}

TwoNumbers normal_block(plr_key key, std::uint64_t index) noexcept {
    const TwoNumbers u = uniform_block(key, index);
    const double radius = std::sqrt(-2.0 * std::log(u.value[0]));
    const double angle = two_pi * u.value[1];
    return {{radius * std::cos(angle), radius * std::sin(angle)}};
}

/// Writes numbers first .. first + count - 1 of the stream that `block` makes.
template <class Block>
void fill(plr_key key, std::uint64_t first, std::int64_t count, double* out, Block&& block) noexcept {
    for (std::int64_t done = 0; done < count;) {
        const std::uint64_t number = first + static_cast<std::uint64_t>(done);
        const TwoNumbers two = block(key, number / 2);
        for (std::uint64_t half = number % 2; half < 2 && done < count; ++half) out[done++] = two.value[half];
    }
}

plr_key derive(plr_key parent, std::uint64_t stream, std::uint64_t step, std::uint64_t item) noexcept {
    return absorb(absorb(absorb(parent, stream), step), item);
}

void uniform(plr_key key, std::uint64_t first, std::int64_t count, double* out) noexcept {
    fill(key, first, count, out, uniform_block);
}

void normal(plr_key key, std::uint64_t first, std::int64_t count, double* out) noexcept {
    fill(key, first, count, out, normal_block);
}

constexpr plr_random service = {sizeof(plr_random), 0, derive, uniform, normal};

}  // namespace

const plr_random& random_service() noexcept { return service; }

plr_key node_key(std::uint64_t seed, std::uint64_t run, const std::string& node) noexcept {
    plr_key key{{seed, run}};
    for (std::size_t begin = 0; begin < node.size(); begin += 8) {
        std::uint64_t word = 0;  // eight characters, the first one lowest, whatever the machine's byte order
        for (std::size_t i = begin; i < std::min(begin + 8, node.size()); ++i)
            word |= std::uint64_t{static_cast<unsigned char>(node[i])} << 8 * (i - begin);
        key = absorb(key, word);
    }
    return absorb(key, node.size());  // so that "a" and "a\0" differ, and an empty name is mixed too
}

}  // namespace pelorus::host
