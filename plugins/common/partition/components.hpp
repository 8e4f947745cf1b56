/// Connected components: a forest in which the root of a tree is its smallest element.
#pragma once

#include <atomic>
#include <cstdint>
#include <new>

#include "memory.hpp"

namespace partition {

/// Union and find with path halving. Links run from larger to smaller elements only, so that the roots are the same whatever
/// the order of joins and however many threads make them.
///
/// Several threads may call all functions at once: parents change by single atomic words, a root gets a parent by compare and
/// exchange, and everything else that is stored is an ancestor already (Anderson, Woll: Wait-free Parallel Algorithms for the
/// Union-Find Problem, STOC 1991). Relaxed order is enough: nothing else is read through the forest.
class Components {
public:
    static constexpr Need need() noexcept { return array<std::atomic<std::uint32_t>>(); }

    /// `size` elements, each alone.
    Components(Memory& memory, std::uint32_t size)
        : parent_(memory.take<std::atomic<std::uint32_t>>(size)), size_(size) {
        for (std::uint32_t i = 0; i < size; ++i) new (parent_ + i) std::atomic<std::uint32_t>(i);
    }

    std::uint32_t size() const noexcept { return size_; }

    /// The smallest element of i's component.
    std::uint32_t root(std::uint32_t i) const noexcept {
        while (true) {
            const std::uint32_t parent = parent_[i].load(std::memory_order_relaxed);
            if (parent == i) return i;
            const std::uint32_t above = parent_[parent].load(std::memory_order_relaxed);
            if (above == parent) return parent;
            parent_[i].store(above, std::memory_order_relaxed);
            i = above;
        }
    }
    bool joined(std::uint32_t a, std::uint32_t b) const noexcept { return root(a) == root(b); }

    /// Answers whether they were apart.
    bool join(std::uint32_t a, std::uint32_t b) noexcept {
        while (true) {
            a = root(a);
            b = root(b);
            if (a == b) return false;
            std::uint32_t& larger = a > b ? a : b;
            const std::uint32_t smaller = a > b ? b : a;
            std::uint32_t expected = larger;
            if (parent_[larger].compare_exchange_strong(expected, smaller, std::memory_order_relaxed)) return true;
        }
    }

private:
    std::atomic<std::uint32_t>* parent_;
    std::uint32_t size_;
};

}  // namespace partition
