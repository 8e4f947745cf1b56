/// One line for a crash: which signal, in which call into which plugin, and what is left in the result folder.
#pragma once

#include <filesystem>

namespace pelorus::cli {

/// From now on SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT (std::terminate included) print one line and end the process with
/// exit code 1. A signal that somebody else handles already is left to them: under AddressSanitizer that is SIGSEGV, SIGBUS and
/// SIGFPE, unless ASAN_OPTIONS says handle_segv=0 and so on; there the line follows the sanitizer's report. Only for a
/// process that is the command's own. [main], once.
void tell_crashes();

/// While it lives, the line of a crash says what is left in this folder.
class CrashFolder {
public:
    explicit CrashFolder(const std::filesystem::path& folder);
    ~CrashFolder();
    CrashFolder(const CrashFolder&) = delete;
    CrashFolder& operator=(const CrashFolder&) = delete;
};

}  // namespace pelorus::cli
