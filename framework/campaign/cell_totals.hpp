/// The blocks of one cell, put together.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "campaign/totals.hpp"

namespace pelorus::campaign {

/// How the runs of a cell are divided: into blocks, which are computed, kept on disk and sent as a whole, and those into at most 32
/// groups, from which intervals are told by leaving one out. Both depend on the number of runs alone.
class Blocks {
public:
    explicit Blocks(std::uint64_t runs);
    std::uint64_t count() const noexcept { return count_; }
    std::uint64_t first_run(std::uint64_t block) const noexcept { return block * size_; }
    /// One behind the last.
    std::uint64_t last_run(std::uint64_t block) const noexcept;
    std::uint64_t groups() const noexcept;
    std::uint64_t group_of(std::uint64_t block) const noexcept { return block * groups() / count_; }

private:
    std::uint64_t runs_, size_, count_;
};

/// Takes blocks in any order and adds them up in that of the runs.
class CellTotals {
public:
    explicit CellTotals(const Blocks& blocks) : blocks_(blocks), groups_(blocks.groups()) {}

    /// Each block once. Throws std::runtime_error where tables of different runs do not fit together.
    void add(std::uint64_t block, Totals totals);
    bool is_complete() const noexcept { return next_ == blocks_.count(); }
    /// The runs of the groups, complete once the cell is.
    const std::vector<Totals>& groups() const noexcept { return groups_; }

private:
    Blocks blocks_;
    std::uint64_t next_ = 0;
    std::map<std::uint64_t, Totals> waiting_;
    std::vector<Totals> groups_;
};

}  // namespace pelorus::campaign
