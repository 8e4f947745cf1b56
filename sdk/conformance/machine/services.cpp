#include "services.hpp"

#include <cstdio>
#include <thread>

#include "watch.hpp"

namespace pelorus::conformance {

Services::Services(const Host& host) : host_services_(host) {}
Services::~Services() = default;

const plr_host* Services::host() {
    // Made anew each time: what is withheld or grown may have changed since.
    // Lines and counts are not kept: the memory would be taken for the plugin's, by the checks that look what it leaves behind.
    log_ = {sizeof log_, PLR_LOG_TRACE, this, [](void*, std::int32_t, const char*) {}};
    diagnostics_ = {static_cast<std::uint32_t>(sizeof diagnostics_) + extra_struct_bytes, 0, this,
                    [](void*, const char*, std::int64_t) {}, [](void*, const char*, const char*, double) {}};
    publish_ = {static_cast<std::uint32_t>(sizeof publish_) + extra_struct_bytes, 0, this, &publish};
    output_ = {static_cast<std::uint32_t>(sizeof output_) + extra_struct_bytes, 0, this, [](void* self) -> const char* {
                   const auto& folder = static_cast<Services*>(self)->output_folder;
                   return folder.empty() ? nullptr : folder.c_str();
               }};
    host_ = {static_cast<std::uint32_t>(sizeof host_) + extra_struct_bytes,
             PLR_ABI_MAJOR,
             abi_minor,
             "conformance",
             this,
             &service};
    return &host_;
}

const void* Services::service(const plr_host* host, const char* id) noexcept {
    const watch::HostWork ours;
    auto& self = *static_cast<Services*>(host->context);
    const std::string wanted = id == nullptr ? "" : id;
    const std::lock_guard<std::mutex> lock(self.mutex_);
    self.asked_for.insert(wanted);
    if (self.withheld.count(wanted) != 0 || self.withheld.count("*") != 0) return nullptr;
    if (wanted == PLR_SERVICE_LOG) return &self.log_;
    if (wanted == PLR_SERVICE_DIAGNOSTICS) return &self.diagnostics_;
    if (wanted == PLR_SERVICE_PUBLISH) return &self.publish_;
    if (wanted == PLR_SERVICE_OUTPUT) return &self.output_;
    if (wanted == PLR_SERVICE_RANDOM) return &self.host_services_.random();
    if (wanted == PLR_SERVICE_FRAMES) return &self.host_services_.frames();
    if (wanted == PLR_SERVICE_PARALLEL) {
        if (!self.parallel_ || self.parallel_->service().threads != self.threads)
            self.parallel_ = self.host_services_.threads(self.threads);
        self.watched_parallel_ = self.parallel_->service();
        self.watched_parallel_.context = &self;
        self.watched_parallel_.run = &run;
        return &self.watched_parallel_;
    }
    return nullptr;
}

namespace {

/// A plugin's body on its way through the threads; what the host does in between is not the plugin's doing.
struct WatchedBody {
    plr_status (*body)(void*, std::int64_t, std::int64_t, plr_scratch*, plr_error*);
    void* argument;
    std::thread::id caller;
    unsigned concerns;
    std::mutex mutex;
    watch::Offence of_workers;
};

plr_status run_watched(void* argument, std::int64_t first, std::int64_t last, plr_scratch* scratch, plr_error* error) {
    auto& watched = *static_cast<WatchedBody*>(argument);
    if (std::this_thread::get_id() == watched.caller) {
        watch::resume(watched.concerns);
        const plr_status status = watched.body(watched.argument, first, last, scratch, error);
        watch::pause();
        return status;
    }
    watch::Guard guard(watched.concerns);
    const plr_status status = watched.body(watched.argument, first, last, scratch, error);
    const watch::Offence offence = guard.end();
    const std::lock_guard<std::mutex> lock(watched.mutex);
    watched.of_workers.add(offence);
    return status;
}

}  // namespace

plr_status Services::run(void* context, std::int64_t count, std::int64_t block,
                         plr_status (*body)(void*, std::int64_t, std::int64_t, plr_scratch*, plr_error*),
                         void* argument, plr_error* error) noexcept {
    const plr_parallel& pool = static_cast<Services*>(context)->parallel_->service();
    WatchedBody watched{body, argument, std::this_thread::get_id(), watch::pause(), {}, {}};
    const plr_status status = pool.run(pool.context, count, block, &run_watched, &watched, error);
    watch::report(watched.of_workers);
    watch::resume(watched.concerns);
    return status;
}

plr_status Services::publish(void* context, std::uint32_t port, const plr_message* message, plr_error* error) noexcept {
    const watch::HostWork ours;
    auto& self = *static_cast<Services*>(context);
    const auto refuse = [&](plr_status status, const std::string& why) {
        self.refused_messages.push_back(why);
        if (error != nullptr && error->code == PLR_OK) {
            error->code = status;
            std::snprintf(error->message, sizeof error->message, "publish: %s", why.c_str());
        }
        return status;
    };
    if (!self.allows_publishing) return refuse(PLR_E_UNSUPPORTED, "only from within receive, emit or finish");
    try {
        self.published.push_back({port, self.host_services_.copy(*message)});
        return PLR_OK;
    } catch (const std::exception& refused) {
        return refuse(PLR_E_ARGUMENT, refused.what());
    }
}

}  // namespace pelorus::conformance
