#include "host/log.hpp"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <atomic>
#include <mutex>
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

/// Where all lines end: standard error, or a target that was set.
class Sink : public spdlog::sinks::base_sink<std::mutex> {
public:
    Sink() { terminal_.set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ [%n] %v"); }
    void set_target(LogTarget target) {
        const std::lock_guard<std::mutex> lock(mutex_);
        target_ = std::move(target);
    }

private:
    void sink_it_(const spdlog::details::log_msg& line) override {
        if (!target_) return terminal_.log(line);
        try {
            target_(abi_level(line.level), {line.logger_name.data(), line.logger_name.size()},
                    {line.payload.data(), line.payload.size()});
        } catch (...) {  // an application's log must not end the run that it tells of
        }
    }
    void flush_() override { terminal_.flush(); }

    spdlog::sinks::stderr_color_sink_st terminal_;
    LogTarget target_;
};

/// Never destroyed: a plugin's deinit may log when static objects are already gone.
const std::shared_ptr<Sink>& sink() {
    static const std::shared_ptr<Sink>* const shared = new auto(std::make_shared<Sink>());
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

void set_log_target(LogTarget target) { sink()->set_target(std::move(target)); }

std::int32_t abi_level(spdlog::level::level_enum level) noexcept {
    switch (level) {
        case spdlog::level::trace:
            return PLR_LOG_TRACE;
        case spdlog::level::debug:
            return PLR_LOG_DEBUG;
        case spdlog::level::info:
            return PLR_LOG_INFO;
        case spdlog::level::warn:
            return PLR_LOG_WARNING;
        default:
            return PLR_LOG_ERROR;
    }
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
    std::vector<std::string> names;
    for (const auto& [level_name, level] : levels) names.push_back(level_name);
    const std::string near = nearest(name, names);
    throw Error(Exit::misuse, "no log level " + name + ": expected trace, debug, info, warning or error" +
                                  (near.empty() ? "" : "; did you mean " + near + "?"));
}

}  // namespace pelorus::host
