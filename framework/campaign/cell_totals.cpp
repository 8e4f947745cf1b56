#include "campaign/cell_totals.hpp"

#include <algorithm>
#include <utility>

namespace pelorus::campaign {

namespace {

constexpr std::uint64_t most_groups = 32;
constexpr std::uint64_t largest_block = 16;  // runs: what a kill costs at most, and what ranks share out

}  // namespace

Blocks::Blocks(std::uint64_t runs)
    : runs_(runs),
      size_(std::min(largest_block, std::max<std::uint64_t>(1, (runs + most_groups - 1) / most_groups))),
      count_((runs + size_ - 1) / size_) {}

std::uint64_t Blocks::last_run(std::uint64_t block) const noexcept { return std::min(runs_, first_run(block + 1)); }

std::uint64_t Blocks::groups() const noexcept { return std::min(count_, most_groups); }

void CellTotals::add(std::uint64_t block, Totals totals) {
    waiting_.emplace(block, std::move(totals));
    for (auto first = waiting_.begin(); first != waiting_.end() && first->first == next_; first = waiting_.begin()) {
        groups_[static_cast<std::size_t>(blocks_.group_of(next_))].merge(std::move(first->second));
        waiting_.erase(first);
        ++next_;
    }
}

}  // namespace pelorus::campaign
