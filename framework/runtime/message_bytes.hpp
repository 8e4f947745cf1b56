/// Messages to bytes and back, for snapshots.
#pragma once

#include <pelorus/abi/abi.h>

#include "runtime/bytes.hpp"
#include "runtime/message_block.hpp"

namespace pelorus::runtime {

/// Writes a message that has passed check_message.
void write_message(ByteWriter& writer, const plr_message& message);

/// Reads a message, checks it as if it were published, and copies it into a block. Throws CorruptBytes.
MessageRef read_message(ByteReader& reader, MessagePool& pool);

}  // namespace pelorus::runtime
