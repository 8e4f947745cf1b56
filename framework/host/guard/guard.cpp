#include "host/guard/guard.hpp"

#include <cstring>
#include <map>

#include <pelorus/abi/abi.h>

#include "host/guard/info.hpp"
#include "host/guard/kinds.hpp"
#include "host/guard/registry.hpp"

namespace pelorus::host {

namespace {

/// How a kind is guarded, or nullptr.
const GuardedKind* kind_of(const std::string& table_id) {
    static const std::map<std::string, GuardedKind> kinds = {
        {PLR_MOTION, guarded_motion()},           {PLR_SENSOR, guarded_sensor()},
        {PLR_ESTIMATOR, guarded_estimator()},     {PLR_EXTENT, guarded_extent()},
        {PLR_PARTITIONER, guarded_partitioner()}, {PLR_WAVEFORM, guarded_waveform()},
        {PLR_TRAJECTORY, guarded_trajectory()}};
    const auto found = kinds.find(table_id);
    return found == kinds.end() ? nullptr : &found->second;
}

/// info is the first function of every kind's table.
struct TableWithInfo {
    plr_table_head head;
    const void* (*info)(const void* self);
};

}  // namespace

void guarded_destroy(void* self) noexcept {
    const GuardRecord* const record = GuardRegistry::of_process().find(self);
    if (record != nullptr)
        tell_fault(*record, "destroy", "its holder " + record->holder + " called it; the host alone ends instances");
}

const void* guarded_extension(const void* self, const char* id) noexcept {
    const GuardRecord* const record = GuardRegistry::of_process().find(self);
    if (record == nullptr) return nullptr;
    try {
        return record->real.table->extension(self, id);
    } catch (...) {
        tell_exception(*record, "extension");
    }
    return nullptr;
}

Guard::Guard(const GuardedPart& part, GuardMode mode, std::shared_ptr<FaultLatch> latch) {
    const GuardedKind* const kind = kind_of(part.table_id);
    if (mode == GuardMode::off || kind == nullptr || part.instance.self == nullptr) return;
    auto record = std::make_unique<GuardRecord>();
    record->address = part.address;
    record->plugin = part.plugin;
    record->holder = part.holder;
    record->real = part.instance;
    record->mode = mode;
    record->input_size = part.input_size;
    record->cells_may_overlap = part.cells_may_overlap;
    record->latch = std::move(latch);
    record->ask_sizes = kind->sizes;
    record->sizes = kind->sizes(part.instance);
    record->info = reinterpret_cast<const TableWithInfo*>(part.instance.table)->info(part.instance.self);
    const std::size_t size = part.instance.table->struct_size;
    record->table = std::make_unique<unsigned char[]>(size);
    std::memcpy(record->table.get(), part.instance.table, size);
    kind->guard(record->table.get());
    if (GuardRegistry::of_process().insert(part.instance.self, *record)) record_ = std::move(record);
}

void Guard::end() noexcept {
    if (record_ != nullptr) GuardRegistry::of_process().remove(record_->real.self);
    record_.reset();
}

Guard::Guard() noexcept = default;
Guard::~Guard() { end(); }
Guard::Guard(Guard&&) noexcept = default;
Guard& Guard::operator=(Guard&& other) noexcept {
    if (this != &other) {
        end();
        record_ = std::move(other.record_);
    }
    return *this;
}

plr_instance Guard::instance() const noexcept { return {record_->real.self, record_->guard_table()}; }

}  // namespace pelorus::host
