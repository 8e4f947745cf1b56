#include "host/guard/memory.hpp"

#include <algorithm>
#include <cstring>

namespace pelorus::host {

namespace {

constexpr std::uint64_t seed = UINT64_C(0xCBF29CE484222325), factor = UINT64_C(0x9E3779B97F4A7C15);
/// A signalling NaN that no arithmetic makes.
constexpr std::uint64_t pattern = UINT64_C(0x7FF4B10C5AFEC0DE);
constexpr std::size_t border = 64;        // words on either side
constexpr std::uintptr_t alignment = 64;  // bytes; what vector instructions care for

std::uint64_t mixed(std::uint64_t state, std::uint64_t word) noexcept {
    state = (state ^ word) * factor;
    return state ^ (state >> 29);
}

std::uint64_t word_at(const void* place) noexcept {
    std::uint64_t word = 0;
    std::memcpy(&word, place, sizeof word);
    return word;
}

std::size_t span_of(const plr_view& view) noexcept {
    if (view.rows <= 0 || view.cols <= 0 || view.count <= 0) return 0;
    return static_cast<std::size_t>((view.rows - 1) * view.row_stride + (view.cols - 1) * view.col_stride +
                                    (view.count - 1) * view.item_stride + 1);
}

}  // namespace

std::uint64_t fingerprint(const void* bytes, std::size_t size) noexcept {
    const auto* at = static_cast<const unsigned char*>(bytes);
    std::uint64_t state = seed;
    for (; size >= sizeof(std::uint64_t); size -= sizeof(std::uint64_t), at += sizeof(std::uint64_t))
        state = mixed(state, word_at(at));
    std::uint64_t rest = 0;
    if (size > 0) std::memcpy(&rest, at, size);
    return mixed(state, rest);
}

std::uint64_t fingerprint(const plr_const_view& view) noexcept {
    std::uint64_t state = seed;
    plr_const_view once = view;
    if (once.item_stride == 0) once.count = std::min<std::int64_t>(once.count, 1);
    any_element(once, [&](const ElementPlace&, std::int64_t offset) {
        state = mixed(state, word_at(view.data + offset));
        return false;
    });
    return state;
}

StandIn::StandIn(const plr_view& view, bool keeps_content) : callers_(view), keeps_content_(keeps_content) {
    constexpr std::size_t words_of_alignment = alignment / sizeof(std::uint64_t);
    words_.assign(span_of(view) + 2 * border + words_of_alignment, pattern);
    const auto wanted = reinterpret_cast<std::uintptr_t>(view.data) % alignment;
    first_ = border;
    while (first_ < border + words_of_alignment &&
           reinterpret_cast<std::uintptr_t>(words_.data() + first_) % alignment != wanted)
        ++first_;
    if (!keeps_content) return;
    any_element(callers_, [&](const ElementPlace&, std::int64_t offset) {
        words_[first_ + static_cast<std::size_t>(offset)] = word_at(callers_.data + offset);
        return false;
    });
}

void StandIn::hand_over() noexcept {
    any_element(callers_, [&](const ElementPlace& place, std::int64_t offset) {
        std::uint64_t& word = words_[first_ + static_cast<std::size_t>(offset)];
        if (word != pattern)
            std::memcpy(callers_.data + offset, &word, sizeof word);
        else if (!keeps_content_ && (unwritten_.empty() || unwritten_.back().item != place.item))
            unwritten_.push_back(place);
        word = pattern;
        return false;
    });
}

bool StandIn::is_intact() const noexcept {
    return std::all_of(words_.begin(), words_.end(), [](std::uint64_t word) { return word == pattern; });
}

}  // namespace pelorus::host
