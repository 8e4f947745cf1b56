// The suites' own plugins by kind and id.
#include <cstring>

#include "../machine/instance.hpp"
#include "reference_parts.hpp"

namespace pelorus::conformance {

namespace {

using Maker = const plr_plugin* (*)();

struct Entry {
    const char* kind;
    Maker make;
};
constexpr Entry entries[] = {
    {"motion", &reference_motion},         {"sensor", &reference_sensor},           {"estimator", &reference_estimator},
    {"extent", &reference_extent},         {"partitioner", &reference_partitioner}, {"waveform", &reference_waveform},
    {"trajectory", &reference_trajectory},
};

}  // namespace

const plr_plugin* reference_part(const std::string& kind) {
    for (const Entry& entry : entries)
        if (kind == entry.kind) return entry.make();
    return nullptr;
}

const plr_plugin* reference_plugin(const std::string& id) {
    for (const Entry& entry : entries)
        if (id == entry.make()->description->id) return entry.make();
    return nullptr;
}

}  // namespace pelorus::conformance
