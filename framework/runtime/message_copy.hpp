/// Deep copies of messages.
#pragma once

#include <pelorus/abi/abi.h>

#include "runtime/message_block.hpp"

namespace pelorus::runtime {

/// Copies a message that has passed check_message into one block: packed views (a scan's common covariance stays one
/// matrix), our own sizes of structs, empty views where there are no entries, no origin. Throws std::bad_alloc.
MessageRef copy_message(MessagePool& pool, const plr_message& message);

}  // namespace pelorus::runtime
