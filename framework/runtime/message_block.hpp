/// Memory of published messages: one block a message, shared by reference count, recycled.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <pelorus/abi/abi.h>

namespace pelorus::runtime {

class MessagePool;

/// The head of a block; what the message points to follows behind it, aligned to 64 bytes.
struct alignas(64) MessageBlock {
    plr_message message;
    MessagePool* pool;
    MessageBlock* next_free;
    std::size_t capacity;  ///< bytes behind the head
    std::size_t size;      ///< of them in use
    std::uint32_t references;
    std::uint32_t size_class;

    unsigned char* payload() noexcept { return reinterpret_cast<unsigned char*>(this + 1); }
};

/// A share in a message. The message does not change any more once a second share exists. The count is a plain number:
/// a runtime and its messages belong to one thread at a time.
class MessageRef {
public:
    MessageRef() noexcept = default;
    explicit MessageRef(MessageBlock* block) noexcept : block_(block) {}  ///< takes over the block's first share
    MessageRef(const MessageRef& other) noexcept : block_(other.block_) {
        if (block_) ++block_->references;
    }
    MessageRef(MessageRef&& other) noexcept : block_(other.block_) { other.block_ = nullptr; }
    MessageRef& operator=(MessageRef other) noexcept {
        MessageBlock* held = block_;
        block_ = other.block_;
        other.block_ = held;
        return *this;
    }
    ~MessageRef();

    explicit operator bool() const noexcept { return block_ != nullptr; }
    const plr_message& operator*() const noexcept { return block_->message; }
    const plr_message* operator->() const noexcept { return &block_->message; }
    /// Of all its bytes, to see whether a receiver changed it.
    std::uint64_t fingerprint() const noexcept;
    /// For its maker, before it is shared.
    plr_message& writable() noexcept { return block_->message; }

private:
    MessageBlock* block_ = nullptr;
};

/// Hands out blocks and takes them back. Sizes are powers of two, so that a stream of scans of about one size settles
/// on a few blocks and allocates no more. Must outlive its messages.
class MessagePool {
public:
    MessagePool() = default;
    MessagePool(const MessagePool&) = delete;
    MessagePool& operator=(const MessagePool&) = delete;
    ~MessagePool();

    /// A block with at least `bytes` behind its head and one share. Throws std::bad_alloc.
    MessageBlock* acquire(std::size_t bytes);
    /// Blocks that were ever allocated.
    std::size_t allocated() const noexcept { return allocated_; }

private:
    friend class MessageRef;
    void release(MessageBlock* block) noexcept;
    std::array<MessageBlock*, 64> free_{};  // by size class: the exponent of two
    std::size_t allocated_ = 0;
};

inline MessageRef::~MessageRef() {
    if (block_ && --block_->references == 0) block_->pool->release(block_);
}

}  // namespace pelorus::runtime
