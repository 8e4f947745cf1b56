/// How far a campaign has come.
#pragma once

#include <chrono>

#include "campaign/engine.hpp"

namespace pelorus::cli {

/// A bar on standard error that is written anew as it is told; where standard error is no terminal, a line a minute.
class CampaignProgress {
public:
    CampaignProgress();
    ~CampaignProgress();
    CampaignProgress(const CampaignProgress&) = delete;
    CampaignProgress& operator=(const CampaignProgress&) = delete;

    void show(const campaign::Advance& advance);

private:
    const bool is_terminal_;
    std::chrono::steady_clock::time_point start_, told_;
};

/// `[#####.....] 12 of 90 cells, 2400 of 18000 runs, 310 runs/s, 50 s left`; `seconds` since the beginning.
std::string progress_text(const campaign::Advance& advance, double seconds, bool with_bar);

}  // namespace pelorus::cli
