/// Is a message what message.h says? Asked of everything that a stage publishes and of everything read from a snapshot.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <pelorus/abi/abi.h>

namespace pelorus::runtime {

/// What is wrong with a message: the field and what was expected; `item` is the entry concerned or -1.
class BadMessage : public std::runtime_error {
public:
    BadMessage(const std::string& text, std::int64_t item = -1) : std::runtime_error(text), item_(item) {}
    std::int64_t item() const noexcept { return item_; }

private:
    std::int64_t item_;
};

/// Memory for the test whether ids are unique; kept by the caller so that it is allocated once.
struct CheckMemory {
    struct Entry {
        std::uint64_t id;
        std::int64_t time;
        std::int64_t index;
    };
    std::vector<Entry> entries;
};

/// Checks sizes of structs, NULLs, counts and shapes, offsets, spaces, finiteness, that status and reduction are known
/// words, that ids are unique (of a scan; of tracks and truth: at one time) and that text columns count into their
/// texts. Throws BadMessage.
void check_message(const plr_message& message, CheckMemory& memory);

/// Same names, units and order.
bool same_space(const plr_space& one, const plr_space& other);

/// Checks that a scan, tracks or truth is one of the streams that its port declared: sensor, space and frame. No
/// streams: everything goes. The message must have passed check_message. Throws BadMessage.
void check_stream(const plr_message& message, const std::vector<plr_stream>& declared);

}  // namespace pelorus::runtime
