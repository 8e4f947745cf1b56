#include "bench.hpp"

namespace pelorus::conformance {

namespace {

std::uint64_t hash(const std::string& text) noexcept {
    std::uint64_t value = 14695981039346656037u;
    for (const char c : text) value = (value ^ static_cast<unsigned char>(c)) * 1099511628211u;
    return value;
}

}  // namespace

std::unique_ptr<Instance> Bench::try_make(const std::string& yaml, const Surroundings& surroundings) const {
    Node node = subject_.node;
    if (!yaml.empty()) node.with = host().settings(yaml, node.with.get());
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
