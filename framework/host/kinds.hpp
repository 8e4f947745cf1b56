/// The kinds of plugin that this host knows, and the call table that each speaks (a new kind is one line here), and the kinds of
/// message that it carries.
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

/// `scan`, `tracks`, ...; for people.
constexpr const char* message_kind_name(std::uint32_t kind) noexcept {
    switch (kind) {
        case PLR_MESSAGE_SCAN:
            return "scan";
        case PLR_MESSAGE_TRACKS:
            return "tracks";
        case PLR_MESSAGE_TRUTH:
            return "truth";
        case PLR_MESSAGE_VALUES:
            return "values";
        case PLR_MESSAGE_TABLE:
            return "table";
        default:
            return "an unknown kind of message";
    }
}

}  // namespace pelorus::host
