/// A message lent to a stage: a copy in memory that nobody may write to and that is gone after the call.
#pragma once

#include <memory>

#include "guarded_memory.hpp"
#include <pelorus/abi/message.h>

namespace pelorus::conformance {

class LentMessage {
public:
    /// A copy of it; all its arrays, texts and structs lie in one piece of memory.
    LentMessage(const plr_message& message, const ZoneName& name);
    const plr_message& message() const noexcept;
    /// From now on a write to any part of it stops the plugin.
    void make_read_only();
    /// From now on whoever touches any part of it is stopped.
    void take_back();

private:
    std::unique_ptr<GuardedMemory> memory_;
};

}  // namespace pelorus::conformance
