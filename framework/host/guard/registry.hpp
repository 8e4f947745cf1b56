/// From the `self` of a guarded instance to its guard record, for the functions of guard tables, which get nothing else.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace pelorus::host {

struct GuardRecord;

/// An open-addressing hash table of atomics. find is wait-free (at most one pass over the table, in practice one or two
/// slots) and may run beside insert and remove; these two take a lock, since instances are made and ended rarely.
///
/// Only who holds a living instance looks it up, so a reader never races with the removal of its own key. A table that has
/// become too small is replaced by one of twice the size and kept, as readers may still be in it; all that were kept are
/// together smaller than the present one.
class GuardRegistry {
public:
    explicit GuardRegistry(std::size_t initial_capacity = 1024);  ///< a power of two
    ~GuardRegistry();
    GuardRegistry(const GuardRegistry&) = delete;
    GuardRegistry& operator=(const GuardRegistry&) = delete;

    /// The one of the process; never destroyed, as plugins may be called until the very end.
    static GuardRegistry& of_process();

    /// False where there is nothing that could be told apart: `self` is NULL, or registered already. Throws std::bad_alloc.
    bool insert(const void* self, const GuardRecord& record);
    /// Forgets `self`, before its instance is destroyed: afterwards its address may come back as another instance's.
    void remove(const void* self) noexcept;
    /// The record, or nullptr. [hot]
    const GuardRecord* find(const void* self) const noexcept;

    std::size_t size() const;
    std::size_t capacity() const;

private:
    struct Slot {
        std::atomic<const void*> self{nullptr};
        std::atomic<const GuardRecord*> record{nullptr};
    };
    struct Table {
        explicit Table(std::size_t capacity) : slots(capacity), mask(capacity - 1) {}
        std::vector<Slot> slots;
        std::size_t mask;
    };
    static std::size_t place(const Table& table, const void* self) noexcept;
    static bool put(Table& table, const void* self, const GuardRecord& record) noexcept;
    void grow();

    std::atomic<Table*> table_;
    mutable std::mutex mutex_;                    // of writers
    std::vector<std::unique_ptr<Table>> tables_;  // the present one last
    std::size_t size_ = 0;
};

}  // namespace pelorus::host
