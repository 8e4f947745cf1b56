#include "bench.hpp"

#include <algorithm>

#include "creation.hpp"

namespace pelorus::conformance {

namespace {

std::uint64_t hash(const std::string& text) noexcept {
    std::uint64_t value = 14695981039346656037u;
    for (const char c : text) value = (value ^ static_cast<unsigned char>(c)) * 1099511628211u;
    return value;
}

/// What a plugin cannot be made without, and nobody but its author knows: leaves the check for want of it.
void skip_for_want_of_subjects(const plr_description& description, const Settings* with, const Host& host) {
    const std::vector<std::string> given = with == nullptr ? std::vector<std::string>() : host.keys(*with);
    for (std::uint32_t i = 0; i < description.parameter_count; ++i) {
        const plr_parameter& parameter = element_of(description.parameters, i);
        if ((parameter.flags & PLR_PARAMETER_REQUIRED) == 0) continue;
        if (std::find(given.begin(), given.end(), parameter.name) == given.end())
            skip(std::string("parameter ") + parameter.name +
                 " has no default; give it a value in a file of subjects (--subjects FILE)");
    }
    for (std::uint32_t i = 0; i < description.slot_count; ++i) {
        const plr_slot& slot = element_of(description.slots, i);
        if (slot.min > 0 && reference_part(slot.kind) == nullptr)
            skip(std::string("slot ") + slot.name + " wants a part of kind " + slot.kind +
                 "; name one in a file of subjects (--subjects FILE)");
    }
}

}  // namespace

std::unique_ptr<Instance> Bench::try_make(const std::string& yaml, const Surroundings& surroundings) const {
    Node node = subject_.node;
    if (!yaml.empty()) node.with = host().settings(yaml, node.with.get());
    if (task_.subjects.empty()) skip_for_want_of_subjects(description(), node.with.get(), host());
    return std::make_unique<Instance>(host(), plugin(), node, surroundings);
}

std::unique_ptr<Instance> Bench::make_with(const std::string& yaml, const Surroundings& surroundings) const {
    try {
        return try_make(yaml, surroundings);
    } catch (const CreateFailed& failed) {
        FAIL("create answered " << failed.what());
    } catch (const Refused& refused) {
        FAIL(refused.what());
    }
    return nullptr;
}

std::unique_ptr<Instance> Bench::make(const Surroundings& surroundings) const { return make_with("", surroundings); }

Sample Bench::sample(std::uint64_t stream) const {
    const plr_key root{{task_.seed, hash(task_.check)}};
    return {host().random(), host().random().derive(root, stream, hash(task_.plugin), hash(subject_.title))};
}

}  // namespace pelorus::conformance
