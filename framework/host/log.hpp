/// The host's log: lines on standard error, through spdlog, each with its writer's name.
#pragma once

#include <memory>
#include <string>

#include <spdlog/logger.h>

namespace pelorus::host {

/// A logger of that name at the level in force. Its sink lives until the very end of the process. Thread-safe.
std::shared_ptr<spdlog::logger> make_logger(const std::string& name);

/// The logger of the host's own parts, named "pelorus". Thread-safe.
spdlog::logger& host_logger();

}  // namespace pelorus::host
