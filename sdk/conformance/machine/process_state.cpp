#include "process_state.hpp"

#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cfenv>
#include <clocale>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>

extern char** environ;

namespace pelorus::conformance {

namespace {

std::size_t entries_of(const char* folder) {
    const std::filesystem::directory_iterator all(folder);
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

std::string address_text(const void* address) {
    char text[32];
    std::snprintf(text, sizeof text, "%p", address);
    return text;
}

std::string signal_name(int signal) {
    const char* const name = sigabbrev_np(signal);
    return name == nullptr ? "signal " + std::to_string(signal) : std::string("SIG") + name;
}

/// Smaller than every normal number: zero where the processor was told to flush such numbers.
bool keeps_denormals() noexcept {
    volatile double small = 2.2250738585072014e-308, quarter = 0.25;
    volatile double smaller = small * quarter;
    volatile double four = 4;
    return smaller * four == small;
}

}  // namespace

std::size_t thread_count() { return entries_of("/proc/self/task"); }
std::size_t open_file_count() { return entries_of("/proc/self/fd"); }

std::size_t bytes_written_to_terminal() {
    std::fflush(nullptr);
    std::size_t bytes = 0;
    for (const int file : {STDOUT_FILENO, STDERR_FILENO}) {
        struct stat status {};
        if (fstat(file, &status) == 0) bytes += static_cast<std::size_t>(status.st_size);
    }
    return bytes;
}

std::vector<Setting> process_settings() {
    std::vector<Setting> settings{
        {"rounding of floating-point numbers", std::to_string(std::fegetround())},
        {"traps of floating-point faults", std::to_string(fegetexcept())},
        {"treatment of denormal numbers",
         keeps_denormals() ? "kept" : "flushed to zero (-ffast-math at the link step)"},
        {"locale", std::setlocale(LC_ALL, nullptr)},
        {"working directory", std::filesystem::current_path().string()},
        {"terminate handler", address_text(reinterpret_cast<const void*>(std::get_terminate()))}};
    const mode_t mask = umask(0);
    umask(mask);
    settings.push_back({"umask", std::to_string(mask)});
    for (int signal = 1; signal < SIGRTMAX; ++signal) {
        struct sigaction action {};
        if (sigaction(signal, nullptr, &action) != 0) continue;
        settings.push_back(
            {"handler of " + signal_name(signal), address_text(reinterpret_cast<const void*>(action.sa_handler))});
    }
    std::string environment;
    for (char** each = environ; *each != nullptr; ++each) environment += std::string(*each) + "\n";
    settings.push_back({"environment", environment});
    return settings;
}

}  // namespace pelorus::conformance
