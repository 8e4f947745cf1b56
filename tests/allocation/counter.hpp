/// Counts the allocations of the calling thread: malloc and its kin are interposed by this executable (counter.cpp), so those of
/// plugins and of the C++ library are seen as well.
#pragma once

#include <cstdint>

namespace pelorus::test {

/// Since the thread began.
std::uint64_t allocations() noexcept;

}  // namespace pelorus::test
