#include "cli/campaign_progress.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "cli/output.hpp"

namespace pelorus::cli {

namespace {

using Clock = std::chrono::steady_clock;

// The cursor goes back to the beginning of the line, so that a line of the log overwrites this one.
constexpr const char* erase_line = "\r\033[K";

std::string duration_text(double seconds) {
    const auto whole = static_cast<long long>(seconds + 0.5);
    if (whole < 100) return fmt::format("{} s", whole);
    if (whole < 6000) return fmt::format("{} min", (whole + 30) / 60);
    return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace

std::string progress_text(const campaign::Advance& advance, double seconds, bool with_bar) {
    std::string text;
    if (with_bar && advance.runs > 0) {
        constexpr std::uint64_t width = 24;
        const auto filled = static_cast<std::size_t>(width * advance.runs_done / advance.runs);
        text = '[' + std::string(filled, '#') + std::string(width - filled, '.') + "] ";
    }
    text += fmt::format("{} of {} cells, {} of {} runs", advance.cells_done, advance.cells, advance.runs_done,
                        advance.runs);
    if (advance.runs_failed > 0) text += fmt::format(" ({} failed)", advance.runs_failed);
    const auto done_now = static_cast<double>(advance.runs_done - advance.runs_kept);
    if (done_now > 0 && seconds > 0) {
        const double rate = done_now / seconds;
        text += fmt::format(", {:.3g} runs/s", rate);
        if (advance.runs_done < advance.runs)
            text +=
                fmt::format(", {} left", duration_text(static_cast<double>(advance.runs - advance.runs_done) / rate));
    }
    return text;
}

CampaignProgress::CampaignProgress() : is_terminal_(error_is_terminal()), start_(Clock::now()), told_(start_) {}

CampaignProgress::~CampaignProgress() {
    if (is_terminal_) tell_raw(erase_line);
}

void CampaignProgress::show(const campaign::Advance& advance) {
    const Clock::time_point now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    if (is_terminal_) return tell_raw(erase_line + progress_text(advance, seconds, true) + '\r');
    if (now - told_ < std::chrono::minutes(1)) return;
    told_ = now;
    tell(progress_text(advance, seconds, false));
}

}  // namespace pelorus::cli
