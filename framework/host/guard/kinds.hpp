/// What the guard knows of each kind of model: one file a kind.
#pragma once

#include "host/guard/record.hpp"

namespace pelorus::host {

struct GuardedKind {
    GuardSizes (*sizes)(const plr_instance& instance);
    /// Replaces the functions in a copy of an instance's table, which may be shorter or longer than today's.
    void (*guard)(unsigned char* table);
};

GuardedKind guarded_motion() noexcept;
GuardedKind guarded_sensor() noexcept;
GuardedKind guarded_estimator() noexcept;
GuardedKind guarded_extent() noexcept;
GuardedKind guarded_partitioner() noexcept;
GuardedKind guarded_waveform() noexcept;
GuardedKind guarded_trajectory() noexcept;

}  // namespace pelorus::host
