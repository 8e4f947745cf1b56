#include "cli/progress.hpp"

#include <fmt/format.h>

#include "cli/output.hpp"

namespace pelorus::cli {

namespace {

// The cursor goes back to the beginning of the line, so that a line of the log overwrites this one.
constexpr const char* erase_line = "\r\033[K";

}  // namespace

Progress::Progress() : visible_(error_is_terminal()), start_(std::chrono::steady_clock::now()), shown_(start_) {}

Progress::~Progress() {
    if (visible_) tell_raw(erase_line);
}

std::function<void(std::int64_t)> Progress::callback() {
    if (!visible_) return {};
    return [this](std::int64_t arrival) { show(arrival); };
}

void Progress::show(std::int64_t arrival) {
    ++events_;
    const auto now = std::chrono::steady_clock::now();
    if (now - shown_ < std::chrono::milliseconds(100)) return;
    shown_ = now;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    tell_raw(fmt::format("{}t = {:.1f} s, {} events in {:.1f} s\r", erase_line, static_cast<double>(arrival) * 1e-9,
                         events_, elapsed));
}

}  // namespace pelorus::cli
