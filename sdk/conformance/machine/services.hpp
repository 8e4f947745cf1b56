/// The services that a plugin under test is given, each of which may be withheld; what came of them is kept.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "host.hpp"

namespace pelorus::conformance {

struct PublishedMessage {
    std::uint32_t port;
    std::shared_ptr<const plr_message> message;
};

/// One host, as an instance sees it. Must outlive the instances made with it.
class Services {
public:
    explicit Services(const Host& host);
    ~Services();
    Services(const Services&) = delete;
    Services& operator=(const Services&) = delete;

    std::set<std::string> withheld;  ///< ids that service() answers with NULL
    std::uint16_t abi_minor = PLR_ABI_MINOR;
    std::uint32_t extra_struct_bytes = 0;  ///< plr_host and the tables of services tell so many bytes more
    std::string output_folder;             ///< "": none
    unsigned threads = 1;                  ///< of parallel
    bool allows_publishing = true;         ///< false: publish answers PLR_E_UNSUPPORTED

    std::vector<PublishedMessage> published;
    std::vector<std::string> refused_messages;  ///< why publish refused, one line each
    std::set<std::string> asked_for;            ///< ids that were asked for

    const plr_host* host();
    const plr_log* log_service() const noexcept { return &log_; }

private:
    static const void* service(const plr_host*, const char* id) noexcept;
    static plr_status run(void*, std::int64_t, std::int64_t,
                          plr_status (*)(void*, std::int64_t, std::int64_t, plr_scratch*, plr_error*), void*,
                          plr_error*) noexcept;
    static plr_status publish(void*, std::uint32_t, const plr_message*, plr_error*) noexcept;

    const Host& host_services_;
    std::unique_ptr<Threads> parallel_;
    std::mutex mutex_;
    plr_host host_{};
    plr_log log_{};
    plr_diagnostics diagnostics_{};
    plr_publish publish_{};
    plr_output output_{};
    plr_parallel watched_parallel_{};
};

}  // namespace pelorus::conformance
