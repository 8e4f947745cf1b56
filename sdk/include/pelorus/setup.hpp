/// What an instance is made from, as `setup(const Setup&)` of a plugin class sees it.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include <pelorus/abi/diagnostics.h>
#include <pelorus/abi/frames.h>
#include <pelorus/abi/log.h>
#include <pelorus/abi/output.h>
#include <pelorus/abi/parallel.h>
#include <pelorus/abi/plugin.h>
#include <pelorus/abi/publish.h>
#include <pelorus/parts.hpp>

namespace pelorus {

/// A host service by the type of its table, or nullptr: service<plr_random>(config).
template <class Service> struct ServiceId;
template <> struct ServiceId<plr_log> { static constexpr const char* id = PLR_SERVICE_LOG; };
template <> struct ServiceId<plr_random> { static constexpr const char* id = PLR_SERVICE_RANDOM; };
template <> struct ServiceId<plr_frames> { static constexpr const char* id = PLR_SERVICE_FRAMES; };
template <> struct ServiceId<plr_parallel> { static constexpr const char* id = PLR_SERVICE_PARALLEL; };
template <> struct ServiceId<plr_publish> { static constexpr const char* id = PLR_SERVICE_PUBLISH; };
template <> struct ServiceId<plr_output> { static constexpr const char* id = PLR_SERVICE_OUTPUT; };
template <> struct ServiceId<plr_diagnostics> { static constexpr const char* id = PLR_SERVICE_DIAGNOSTICS; };

class Setup {
public:
    explicit Setup(const plr_config& config) : config_(config) {}

    const plr_config& raw() const noexcept { return config_; }
    std::string address() const { return config_.address; }
    std::string frame() const { return config_.frame; }
    plr_key key() const noexcept { return config_.key; }

    /// All parts of a slot, in the order of the file.
    template <class PartType> std::vector<PartType> parts(const std::string& slot) const {
        std::vector<PartType> found;
        const char* at = reinterpret_cast<const char*>(config_.parts);
        for (std::uint32_t i = 0; i < config_.part_count; ++i) {
            const auto& part = *reinterpret_cast<const plr_part*>(at);
            if (slot == part.slot) found.emplace_back(part);
            at += part.struct_size;
        }
        return found;
    }
    /// The slot's only part; an empty PartType where there is none.
    template <class PartType> PartType optional_part(const std::string& slot) const {
        const auto found = parts<PartType>(slot);
        return found.empty() ? PartType{} : found.front();
    }
    /// The slot's only part. Throws PartError where there is none.
    template <class PartType> PartType part(const std::string& slot) const {
        const auto found = parts<PartType>(slot);
        if (found.empty()) throw PartError(slot, "slot " + slot + " is empty");
        return found.front();
    }

    template <class Service> const Service* optional_service() const noexcept {
        return static_cast<const Service*>(config_.host->service(config_.host, ServiceId<Service>::id));
    }
    /// Throws UnsupportedError where this host does not offer it.
    template <class Service> const Service& service() const {
        const Service* found = optional_service<Service>();
        if (found == nullptr) throw UnsupportedError(std::string("this host has no service ") + ServiceId<Service>::id);
        return *found;
    }
    void log(int level, const std::string& line) const {
        const plr_log* log = optional_service<plr_log>();
        if (log != nullptr && level >= log->level) log->write(log->context, level, line.c_str());
    }

private:
    const plr_config& config_;
};

/// Where a model finds its inputs in a call. Filled once, at creation.
class InputTable {
public:
    void complete(const plr_config& config, const plr_description& description) {
        std::int64_t offset = config.input_offset;
        const char* at = reinterpret_cast<const char*>(description.inputs);
        for (std::uint32_t i = 0; i < description.input_count; ++i) {
            const auto& input = *reinterpret_cast<const plr_input*>(at);
            places_.push_back({offset, input.defaults});
            offset += input.size;
            at += input.struct_size;
        }
    }
    /// The values of input `index` (order of declaration) for item i of a call.
    const double* operator()(const plr_call& call, std::int64_t i, std::size_t index) const noexcept {
        const Place& place = places_[index];
        return call.inputs == nullptr ? place.defaults : call.inputs + i * call.input_stride + place.offset;
    }

private:
    struct Place {
        std::int64_t offset;
        const double* defaults;
    };
    std::vector<Place> places_;
};

}  // namespace pelorus
