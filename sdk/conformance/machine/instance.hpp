/// Instances of plugins, made as a host makes them: values from the description's defaults and the subject's settings, parts from
/// the subject, from where the host looks for plugins, or from the suites' own reference plugins.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "host.hpp"
#include "services.hpp"

namespace pelorus::conformance {

/// What may differ from an ordinary host when an instance is made.
struct Surroundings {
    Services* services = nullptr;          ///< nullptr: services of the instance's own
    std::uint32_t extra_struct_bytes = 0;  ///< structs of plr_config and below grow by so many bytes at the tail
    plr_key key{{0x243F6A8885A308D3u, 0x13198A2E03707344u}};
};

/// Raised by create: the plugin's own refusal.
struct CreateFailed : std::runtime_error {
    CreateFailed(plr_status status_, const plr_error& error_);
    plr_status status;
    plr_error error;
};

/// A living instance and all below it; destroyed holders first.
class Instance {
public:
    /// Throws Refused for what the host refuses, CreateFailed for what the plugin refuses.
    Instance(const Host& host, const plr_plugin& plugin, const Node& node, const Surroundings& surroundings);
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    const plr_plugin& plugin() const noexcept;
    const plr_description& description() const noexcept { return *plugin().description; }
    const plr_config& config() const noexcept;
    void* self() const noexcept;
    const plr_table_head& head() const noexcept;
    template <class Table> const Table& table() const noexcept { return reinterpret_cast<const Table&>(head()); }
    /// A table of the instance's optional abilities, or nullptr.
    template <class Extension> const Extension* extension(const char* id) const noexcept {
        return head().extension == nullptr ? nullptr : static_cast<const Extension*>(head().extension(self(), id));
    }
    /// The defaults of all inputs of the tree, as plr_call.inputs wants them.
    const std::vector<double>& inputs() const noexcept { return inputs_; }
    Services& services() noexcept { return *services_; }
    /// A part that stands in a slot of the instance, or nullptr.
    const plr_part* part(const std::string& slot) const;
    /// Ends it now, before its parts.
    void destroy();

private:
    struct Living;
    Living& create(const Host& host, const plr_plugin& plugin, const Node& node, const std::string& address,
                   const Surroundings& surroundings, std::int64_t& input_offset);

    std::unique_ptr<Services> own_services_;
    Services* services_ = nullptr;
    std::vector<std::unique_ptr<Living>> living_;  // in the order of creation: the instance itself last
    std::vector<double> inputs_;
};

/// The suites' own plugin for a slot of that kind, or nullptr: simple, and right by inspection.
const plr_plugin* reference_part(const std::string& kind);
const plr_plugin* reference_plugin(const std::string& id);

}  // namespace pelorus::conformance
