/// The host that the conformance suites (sdk/conformance) rest on: this one, by its own parts.
#pragma once

#include <map>
#include <memory>

#include "conformance/machine/host.hpp"
#include "host/catalog.hpp"
#include "host/services.hpp"
#include "runtime/message_block.hpp"
#include "runtime/message_check.hpp"

namespace pelorus::conform {

class SuiteHost : public conformance::Host {
public:
    /// `catalog` offers the plugins that subjects name as parts.
    explicit SuiteHost(host::Catalog& catalog) : catalog_(catalog) {}

    std::vector<conformance::ManifestEntry> manifests(const std::filesystem::path& library) const override;
    std::shared_ptr<const conformance::Settings> settings(const std::string& yaml,
                                                          const conformance::Settings* below) const override;
    std::unique_ptr<conformance::Values> values(const plr_parameter* first, std::uint32_t count,
                                                const conformance::Settings* with,
                                                const std::string& plugin) const override;
    std::vector<std::string> keys(const conformance::Settings& with) const override;
    void check_keys(const conformance::Settings& with, const std::vector<std::string>& known,
                    const std::string& plugin) const override;
    std::vector<conformance::Subject> subjects(const std::filesystem::path& file) const override;
    std::string description_problem(const plr_description& description) const override;
    std::string instance_problem(const plr_plugin& plugin, const plr_instance& instance) const override;
    const plr_plugin& plugin(const std::string& id) const override;
    const plr_random& random() const override { return host::random_service(); }
    const plr_frames& frames() const override { return frames_.service(); }
    std::unique_ptr<conformance::Threads> threads(unsigned count) const override;
    std::shared_ptr<const plr_message> copy(const plr_message& message) const override;
    void check_stream(const plr_message& message, const plr_port_type& declared) const override;

private:
    host::Catalog& catalog_;
    host::FrameTree frames_;
    mutable runtime::MessagePool messages_;
    mutable runtime::CheckMemory check_memory_;
};

}  // namespace pelorus::conform
