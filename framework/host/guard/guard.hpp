/// The guard around model plugins: holders call models directly, so the host puts a table of its own into the part that a holder
/// receives. `self` stays the plugin's: extension tables, those that the host does not know included, go on working.
#pragma once

#include <memory>
#include <string>

#include <pelorus/abi/plugin.h>

#include "host/guard/fault.hpp"
#include "host/guard/mode.hpp"

namespace pelorus::host {

struct GuardRecord;

/// What is to be guarded.
struct GuardedPart {
    std::string address, plugin;  ///< `tracker.estimator.motion`, `motion.singer`
    std::string holder;           ///< address of the instance in whose slot it stands
    std::string table_id;         ///< which struct the instance's table is
    plr_instance instance{};      ///< has been found to keep its kind's contract of creation
    std::int64_t input_size = 0;  ///< doubles an item in plr_call.inputs
    bool cells_may_overlap = false;
};

/// The guard of one instance. It ends before the instance does.
class Guard {
public:
    Guard() noexcept;  ///< of nothing
    /// Guards the instance, unless the mode is off, the host knows no such kind, or `self` cannot be told apart (NULL, or that of
    /// another instance). Throws std::bad_alloc.
    Guard(const GuardedPart& part, GuardMode mode, std::shared_ptr<FaultLatch> latch);
    ~Guard();
    Guard(Guard&&) noexcept;
    Guard& operator=(Guard&&) noexcept;

    bool is_on() const noexcept { return record_ != nullptr; }
    /// What the holder gets instead of the instance; call only if it is on.
    plr_instance instance() const noexcept;

private:
    void end() noexcept;
    std::unique_ptr<GuardRecord> record_;
};

}  // namespace pelorus::host
