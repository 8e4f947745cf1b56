/// The parts of guard tables that make no model call: destroy, extension, info.
#pragma once

#include "host/guard/guarded_call.hpp"

namespace pelorus::host {

void guarded_destroy(void* self) noexcept;
const void* guarded_extension(const void* self, const char* id) noexcept;

/// Latches a fault of a call that answers no status.
void tell_fault(const GuardRecord& record, const char* function, const std::string& text) noexcept;
/// Latches the exception that is being handled.
void tell_exception(const GuardRecord& record, const char* function) noexcept;

template <class Table, class Info> const Info* guarded_info(const void* self) noexcept {
    const GuardRecord* const record = GuardRegistry::of_process().find(self);
    if (record == nullptr) return nullptr;
    try {
        if (const Info* answer = real_table<Table>(*record).info(self)) return answer;
        tell_fault(*record, "info", "it answered NULL");
    } catch (...) {
        tell_exception(*record, "info");
    }
    return static_cast<const Info*>(record->info);
}

template <class Table, class Info> void guard_head(unsigned char* table) noexcept {
    auto& copy = *reinterpret_cast<Table*>(table);
    copy.head.destroy = &guarded_destroy;
    if (copy.head.extension != nullptr) copy.head.extension = &guarded_extension;
    copy.info = &guarded_info<Table, Info>;
}

inline std::int64_t size_of_space(const plr_space* space) noexcept { return space == nullptr ? 0 : space->size; }

template <class Table> const auto& info_of(const plr_instance& instance) {
    const auto* const info = reinterpret_cast<const Table*>(instance.table)->info(instance.self);
    if (info == nullptr) throw BrokenContract("info() answers NULL");
    return *info;
}

}  // namespace pelorus::host
