/// From labels to lists: which points have the same label.
#pragma once

#include <cstdint>
#include <limits>

#include "memory.hpp"

namespace partition {

/// The points of each label, in the order that the ABI wants: members ascend, groups follow in the order of their first members.
class Groups {
public:
    static constexpr Need need() noexcept {
        return array<std::uint32_t>() + array<std::uint32_t>(1) + array<std::uint32_t>();
    }

    /// label(i) < size for points 0 .. size - 1; equal labels, same group.
    template <class Label> Groups(Memory& memory, std::uint32_t size, const Label& label) {
        constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
        auto* const group_of = memory.take<std::uint32_t>(size);  // a label
        offsets_ = memory.take<std::uint32_t>(size + std::size_t{1});
        members_ = memory.take<std::uint32_t>(size);
        for (std::uint32_t i = 0; i < size; ++i) group_of[i] = none;
        for (std::uint32_t i = 0; i < size; ++i) {
            std::uint32_t& group = group_of[label(i)];
            if (group == none) offsets_[group = count_++] = 0;
            ++offsets_[group];
        }
        // Each offset runs from the group's first place to its end, which is the next one's first.
        std::uint32_t sum = 0;
        for (std::uint32_t group = 0; group < count_; ++group) {
            const std::uint32_t own = offsets_[group];
            offsets_[group] = sum;
            sum += own;
        }
        for (std::uint32_t i = 0; i < size; ++i) members_[offsets_[group_of[label(i)]]++] = i;
        for (std::uint32_t group = count_; group > 0; --group) offsets_[group] = offsets_[group - 1];
        offsets_[0] = 0;
    }

    std::uint32_t count() const noexcept { return count_; }
    const std::uint32_t* begin(std::uint32_t group) const noexcept { return members_ + offsets_[group]; }
    std::uint32_t size(std::uint32_t group) const noexcept { return offsets_[group + 1] - offsets_[group]; }

private:
    std::uint32_t count_ = 0;
    std::uint32_t *offsets_, *members_;
};

}  // namespace partition
