#include "runtime/message_block.hpp"

#include <cstring>
#include <new>

#include "host/guard/memory.hpp"

namespace pelorus::runtime {

std::uint64_t MessageRef::fingerprint() const noexcept {
    return host::fingerprint(&block_->message, sizeof block_->message) ^
           host::fingerprint(block_->payload(), block_->size);
}
namespace {

constexpr std::uint32_t smallest_class = 9;  // 512 bytes: an empty scan with its space

std::uint32_t class_of(std::size_t bytes) {
    std::uint32_t exponent = smallest_class;
    while ((std::size_t{1} << exponent) < bytes)
        if (++exponent > 46) throw std::bad_alloc();
    return exponent;
}

}  // namespace

MessageBlock* MessagePool::acquire(std::size_t bytes) {
    const std::uint32_t size_class = class_of(bytes);
    MessageBlock* block = free_[size_class];
    if (block) {
        free_[size_class] = block->next_free;
    } else {
        const std::size_t capacity = std::size_t{1} << size_class;
        void* memory = ::operator new (sizeof(MessageBlock) + capacity, std::align_val_t{alignof(MessageBlock)});
        block = new (memory) MessageBlock{};
        block->pool = this;
        block->capacity = capacity;
        block->size_class = size_class;
        std::memset(block->payload(), 0, capacity);  // what lies between fields is fingerprinted, too
        ++allocated_;
    }
    block->next_free = nullptr;
    block->references = 1;
    block->size = bytes;
    return block;
}

void MessagePool::release(MessageBlock* block) noexcept {
    block->next_free = free_[block->size_class];
    free_[block->size_class] = block;
}

MessagePool::~MessagePool() {
    for (MessageBlock* block : free_)
        while (block) {
            MessageBlock* next = block->next_free;
            ::operator delete (block, std::align_val_t{alignof(MessageBlock)});
            block = next;
        }
}

}  // namespace pelorus::runtime
