#include <spdlog/logger.h>

#include <cstring>
#include <limits>

#include "host/log.hpp"
#include "host/plugin_error.hpp"
#include "host/services.hpp"

namespace pelorus::host {

namespace {

constexpr std::size_t longest_line = 1u << 14;
constexpr std::size_t longest_name = 256;

spdlog::level::level_enum spdlog_level(std::int32_t level) noexcept {
    if (level <= PLR_LOG_TRACE) return spdlog::level::trace;
    if (level == PLR_LOG_DEBUG) return spdlog::level::debug;
    if (level == PLR_LOG_INFO) return spdlog::level::info;
    return level == PLR_LOG_WARNING ? spdlog::level::warn : spdlog::level::err;
}

}  // namespace

InstanceHost::InstanceHost(std::string address, std::string plugin_id, Shared shared)
    : address_(std::move(address)), plugin_id_(std::move(plugin_id)), shared_(std::move(shared)) {
    logger_ = make_logger(plugin_id_.empty() ? address_ : address_ + " (" + plugin_id_ + ")");
    log_ = {sizeof log_, abi_level(logger_->level()), this, write_log};
    publish_ = {sizeof publish_, 0, this, publish};
    diagnostics_ = {sizeof diagnostics_, 0, this, count, gauge};
    output_ = {sizeof output_, 0, this, output_folder};
    host_ = {sizeof host_, PLR_ABI_MAJOR, PLR_ABI_MINOR, PELORUS_VERSION, this, service};
}

InstanceHost::~InstanceHost() = default;

const void* InstanceHost::service(const plr_host* host, const char* id) noexcept {
    if (host == nullptr || id == nullptr) return nullptr;
    const auto& self = *static_cast<const InstanceHost*>(host->context);
    const std::string_view wanted = id;
    if (wanted == PLR_SERVICE_LOG) return &self.log_;
    if (wanted == PLR_SERVICE_RANDOM) return &random_service();
    if (wanted == PLR_SERVICE_PUBLISH) return &self.publish_;
    if (wanted == PLR_SERVICE_DIAGNOSTICS) return &self.diagnostics_;
    if (wanted == PLR_SERVICE_OUTPUT) return &self.output_;
    if (wanted == PLR_SERVICE_FRAMES && self.shared_.frames != nullptr) return &self.shared_.frames->service();
    if (wanted == PLR_SERVICE_PARALLEL && self.shared_.pool != nullptr) return &self.shared_.pool->service();
    return nullptr;
}

plr_status InstanceHost::publish(void* context, std::uint32_t port, const plr_message* message,
                                 plr_error* error) noexcept {
    const auto& self = *static_cast<const InstanceHost*>(context);
    if (message == nullptr) return tell(error, PLR_E_ARGUMENT, "publish: the message is NULL");
    if (self.publisher_ == nullptr)
        return tell(error, PLR_E_UNSUPPORTED,
                    "publish: only a stage of a running graph can, from within receive, emit or finish");
    return answer(error, [&](plr_error& own) { return self.publisher_->publish(port, *message, &own); });
}

void InstanceHost::write_log(void* context, std::int32_t level, const char* text) noexcept {
    auto& self = *static_cast<InstanceHost*>(context);
    plr_error unused = empty_error();  // a line that cannot be written for want of memory is lost, nothing else
    guarded(unused, [&] {
        if (self.logger_->should_log(spdlog_level(level)))
            self.logger_->log(spdlog_level(level), spdlog::string_view_t(one_line(text, longest_line)));
        return PLR_OK;
    });
}

void InstanceHost::count(void* context, const char* name, std::int64_t by) noexcept {
    auto& self = *static_cast<InstanceHost*>(context);
    plr_error error = empty_error();
    const auto add = [&] {
        const std::lock_guard<std::mutex> lock(self.diagnostics_mutex_);
        std::int64_t& counter = self.counters_[one_line(name, longest_name)];
        if (__builtin_add_overflow(counter, by, &counter))  // a full counter stays full
            counter = by > 0 ? std::numeric_limits<std::int64_t>::max() : std::numeric_limits<std::int64_t>::min();
        return PLR_OK;
    };
    if (guarded(error, add) != PLR_OK) write_log(context, PLR_LOG_ERROR, error.message);
}

void InstanceHost::gauge(void* context, const char* name, const char* unit, double value) noexcept {
    auto& self = *static_cast<InstanceHost*>(context);
    plr_error error = empty_error();
    const auto set = [&] {
        const std::lock_guard<std::mutex> lock(self.diagnostics_mutex_);
        self.gauges_[one_line(name, longest_name)] = {one_line(unit, longest_name), value};
        return PLR_OK;
    };
    if (guarded(error, set) != PLR_OK) write_log(context, PLR_LOG_ERROR, error.message);
}

const char* InstanceHost::output_folder(void* context) noexcept {
    const std::string* folder = static_cast<InstanceHost*>(context)->shared_.output_folder;
    return folder == nullptr || folder->empty() ? nullptr : folder->c_str();
}

std::map<std::string, std::int64_t> InstanceHost::counters() const {
    const std::lock_guard<std::mutex> lock(diagnostics_mutex_);
    return counters_;
}

std::map<std::string, InstanceHost::Gauge> InstanceHost::gauges() const {
    const std::lock_guard<std::mutex> lock(diagnostics_mutex_);
    return gauges_;
}

void InstanceHost::restore(std::map<std::string, std::int64_t> counters, std::map<std::string, Gauge> gauges) {
    const std::lock_guard<std::mutex> lock(diagnostics_mutex_);
    counters_ = std::move(counters);
    gauges_ = std::move(gauges);
}

}  // namespace pelorus::host
