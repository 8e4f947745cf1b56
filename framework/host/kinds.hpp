/// The kinds of plugin that this host knows, and the call table that each speaks. A new kind is one line here.
#pragma once

#include <string_view>

#include <pelorus/abi/abi.h>

namespace pelorus::host {

struct Kind {
    const char* name;
    const char* table_id;  ///< the only one that this host serves
    bool is_stage;         ///< a node of the graph; otherwise a model that stands in a slot
};

inline constexpr Kind kinds[] = {
    {"motion", PLR_MOTION, false},
    {"sensor", PLR_SENSOR, false},
    {"estimator", PLR_ESTIMATOR, false},
    {"extent", PLR_EXTENT, false},
    {"partitioner", PLR_PARTITIONER, false},
    {"waveform", PLR_WAVEFORM, false},
    {"trajectory", PLR_TRAJECTORY, false},
    {"source", PLR_STAGE, true},
    {"registration", PLR_STAGE, true},
    {"fusion", PLR_STAGE, true},
    {"tracker", PLR_STAGE, true},
    {"scheduler", PLR_STAGE, true},
    {"analyzer", PLR_STAGE, true},
    {"sink", PLR_STAGE, true},
};

/// The kind of that name, or nullptr.
constexpr const Kind* find_kind(std::string_view name) noexcept {
    for (const Kind& kind : kinds)
        if (name == kind.name) return &kind;
    return nullptr;
}

}  // namespace pelorus::host
