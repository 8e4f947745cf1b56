#include "host/log.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>

#include <atomic>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/services.hpp"

namespace pelorus::host {

namespace {

std::atomic<spdlog::level::level_enum>& level_in_force() {
    static std::atomic<spdlog::level::level_enum> level{spdlog::level::info};
    return level;
}

/// Never destroyed: a plugin's deinit may log when static objects are already gone.
const spdlog::sink_ptr& sink() {
    static const spdlog::sink_ptr* const shared = [] {
        auto made = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
        made->set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ [%n] %v");
        return new spdlog::sink_ptr(std::move(made));
    }();
    return *shared;
}

}  // namespace

std::shared_ptr<spdlog::logger> make_logger(const std::string& name) {
    auto logger = std::make_shared<spdlog::logger>(name, sink());
    logger->set_level(level_in_force());
    logger->flush_on(spdlog::level::trace);
    return logger;
}

spdlog::logger& host_logger() {
    static const std::shared_ptr<spdlog::logger>* const logger = new auto(make_logger("pelorus"));
    return **logger;
}

void set_log_level(const std::string& name) {
    static const std::vector<std::pair<std::string, spdlog::level::level_enum>> levels = {
        {"trace", spdlog::level::trace},
        {"debug", spdlog::level::debug},
        {"info", spdlog::level::info},
        {"warning", spdlog::level::warn},
        {"error", spdlog::level::err}};
    for (const auto& [level_name, level] : levels) {
        if (name != level_name) continue;
        level_in_force() = level;
        host_logger().set_level(level);
        return;
    }
    throw Error(Exit::misuse, "no log level " + name + ": expected trace, debug, info, warning or error");
}

}  // namespace pelorus::host
