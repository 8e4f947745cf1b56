/// What happens in the process that tries one check.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench.hpp"

namespace pelorus::conformance {

enum class Verdict { pass, warn, fail, crash, hang, skipped };
const char* verdict_name(Verdict verdict) noexcept;
std::optional<Verdict> find_verdict(const std::string& name) noexcept;
/// Whether it is the plugin's fault.
bool is_bad(Verdict verdict) noexcept;

/// What a check came to.
struct Outcome {
    Verdict verdict = Verdict::pass;
    std::vector<std::string> messages;  ///< failures, then warnings; one or more lines each
    std::vector<std::string> notes;     ///< figures
    std::string reason;                 ///< why it was skipped
    double seconds = 0;
};

/// Runs the task's check in this process and writes the outcome, one JSON object, to a file descriptor. Does not return.
[[noreturn]] void run_child(const Task& task, int descriptor);

/// The outcome that a child wrote; one that ended without is a crash.
Outcome read_outcome(const std::string& written);

}  // namespace pelorus::conformance
