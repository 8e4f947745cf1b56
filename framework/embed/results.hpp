/// What nodes have told so far, in the structs of embed.h.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include <pelorus/embed.h>

#include "report/summary.hpp"
#include "report/timing.hpp"

namespace pelorus::embed {

/// Owns everything that its structs point to.
class Results {
public:
    Results(report::Cell cell, report::Timings timings);
    Results(const Results&) = delete;
    Results& operator=(const Results&) = delete;

    const std::vector<pelorus_scalar_info>& scalars() const noexcept { return scalars_; }
    const std::vector<plr_table>& tables() const noexcept { return tables_; }
    const std::vector<pelorus_diagnostic_info>& diagnostics() const noexcept { return diagnostics_; }

private:
    void add_table(const report::TableResult& table);
    void add_diagnostics(const report::NodeReport& node);

    report::Cell cell_;
    report::Timings timings_;
    std::deque<std::vector<plr_column>> columns_;
    std::deque<std::vector<const char*>> texts_;
    std::vector<pelorus_scalar_info> scalars_;
    std::vector<plr_table> tables_;
    std::vector<pelorus_diagnostic_info> diagnostics_;
};

}  // namespace pelorus::embed
