/// The host's log: lines on standard error or to the application that embeds the host, through spdlog, each with its
/// writer's name.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <spdlog/logger.h>

namespace pelorus::host {

/// A logger of that name at the level in force. Its sink lives until the very end of the process. Thread-safe.
std::shared_ptr<spdlog::logger> make_logger(const std::string& name);

/// Takes lines instead of standard error: level (PLR_LOG_...), writer's name, text. Called by any thread, one at a time; what it
/// throws is lost.
using LogTarget = std::function<void(std::int32_t level, const std::string& name, const std::string& line)>;

/// For the whole process, loggers that there are included; nullptr: standard error. After it the target before is not called
/// any more. Thread-safe.
void set_log_target(LogTarget target);

/// PLR_LOG_... of spdlog's level.
std::int32_t abi_level(spdlog::level::level_enum level) noexcept;

/// The logger of the host's own parts, named "pelorus". Thread-safe.
spdlog::logger& host_logger();

}  // namespace pelorus::host
