#include "host/guard/registry.hpp"

#include <cstdint>

namespace pelorus::host {

namespace {

const char removed_mark = 0;
const void* const removed = &removed_mark;  // a slot whose key has gone; keys beyond it are still to be found

}  // namespace

GuardRegistry::GuardRegistry(std::size_t initial_capacity) {
    tables_.push_back(std::make_unique<Table>(initial_capacity));
    table_.store(tables_.back().get(), std::memory_order_release);
}

GuardRegistry::~GuardRegistry() = default;

GuardRegistry& GuardRegistry::of_process() {
    static GuardRegistry* const registry = new GuardRegistry;
    return *registry;
}

std::size_t GuardRegistry::place(const Table& table, const void* self) noexcept {
    const auto address = static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(self));
    return static_cast<std::size_t>((address * UINT64_C(0x9E3779B97F4A7C15)) >> 32) & table.mask;
}

bool GuardRegistry::put(Table& table, const void* self, const GuardRecord& record) noexcept {
    Slot* free = nullptr;
    std::size_t at = place(table, self);
    for (std::size_t probe = 0; probe <= table.mask; ++probe, at = (at + 1) & table.mask) {
        Slot& slot = table.slots[at];
        const void* const key = slot.self.load(std::memory_order_relaxed);
        if (key == self) return false;
        if (free == nullptr && (key == nullptr || key == removed)) free = &slot;
        if (key == nullptr) break;
    }
    // There is room: the table is never more than half full.
    free->record.store(&record, std::memory_order_relaxed);
    free->self.store(self, std::memory_order_release);
    return true;
}

bool GuardRegistry::insert(const void* self, const GuardRecord& record) {
    if (self == nullptr) return false;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (2 * (size_ + 1) > tables_.back()->slots.size()) grow();
    if (!put(*tables_.back(), self, record)) return false;
    ++size_;
    return true;
}

void GuardRegistry::grow() {
    auto larger = std::make_unique<Table>(2 * tables_.back()->slots.size());
    for (const Slot& slot : tables_.back()->slots) {
        const void* const key = slot.self.load(std::memory_order_relaxed);
        if (key != nullptr && key != removed) put(*larger, key, *slot.record.load(std::memory_order_relaxed));
    }
    tables_.push_back(std::move(larger));
    table_.store(tables_.back().get(), std::memory_order_release);
}

void GuardRegistry::remove(const void* self) noexcept {
    if (self == nullptr) return;
    const std::lock_guard<std::mutex> lock(mutex_);
    Table& table = *tables_.back();
    std::size_t at = place(table, self);
    for (std::size_t probe = 0; table.slots[at].self.load(std::memory_order_relaxed) != self;
         ++probe, at = (at + 1) & table.mask)
        if (probe == table.mask || table.slots[at].self.load(std::memory_order_relaxed) == nullptr) return;
    table.slots[at].self.store(removed, std::memory_order_release);
    --size_;
    // Marks that no search has to pass any more are cleared, so that they do not pile up.
    if (table.slots[(at + 1) & table.mask].self.load(std::memory_order_relaxed) != nullptr) return;
    for (; table.slots[at].self.load(std::memory_order_relaxed) == removed; at = (at - 1) & table.mask)
        table.slots[at].self.store(nullptr, std::memory_order_release);
}

const GuardRecord* GuardRegistry::find(const void* self) const noexcept {
    const Table& table = *table_.load(std::memory_order_acquire);
    std::size_t at = place(table, self);
    for (std::size_t probe = 0; probe <= table.mask; ++probe, at = (at + 1) & table.mask) {
        const Slot& slot = table.slots[at];
        const void* const key = slot.self.load(std::memory_order_acquire);
        if (key == self && self != nullptr) return slot.record.load(std::memory_order_relaxed);
        if (key == nullptr) return nullptr;
    }
    return nullptr;
}

std::size_t GuardRegistry::size() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return size_;
}

std::size_t GuardRegistry::capacity() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return tables_.back()->slots.size();
}

}  // namespace pelorus::host
