/// The plugins that stand in an instance's slots, as their holder calls them: a table and an instance, nothing in between.
#pragma once

#include <cstddef>
#include <cstring>
#include <string>

#include <pelorus/abi/estimator.h>
#include <pelorus/abi/extent.h>
#include <pelorus/abi/motion.h>
#include <pelorus/abi/partitioner.h>
#include <pelorus/abi/sensor.h>
#include <pelorus/abi/trajectory.h>
#include <pelorus/abi/waveform.h>
#include <pelorus/failure.hpp>

namespace pelorus {

/// What all parts have in common. Cheap to copy; valid as long as the holder.
template <class Table> class Part {
public:
    Part() = default;
    explicit Part(const plr_part& part)
        : part_(&part), table_(reinterpret_cast<const Table*>(part.instance.table)), self_(part.instance.self) {}

    explicit operator bool() const noexcept { return part_ != nullptr; }
    std::string name() const { return part_->name; }
    std::string address() const { return part_->address; }
    std::string id() const { return part_->description->id; }
    const plr_part& raw() const noexcept { return *part_; }
    const Table& table() const noexcept { return *table_; }
    const void* self() const noexcept { return self_; }

    /// The instance's extension of that id, or nullptr.
    template <class Extension> const Extension* extension(const char* id) const noexcept {
        const auto& head = table_->head;
        return head.extension == nullptr ? nullptr : static_cast<const Extension*>(head.extension(self_, id));
    }

    /// Calls a function of the table: part.call(&plr_motion::propagate, call, args). PLR_E_UNSUPPORTED where it is absent.
    template <class Function, class... Arguments>
    plr_status call(Function Table::*function, const plr_call& call, const Arguments&... arguments) const noexcept {
        const Function target = table_->*function;
        return target == nullptr ? static_cast<plr_status>(PLR_E_UNSUPPORTED) : target(self_, &call, &arguments...);
    }

protected:
    const plr_part* part_ = nullptr;
    const Table* table_ = nullptr;
    void* self_ = nullptr;
};

/// A part of a kind whose table answers info().
template <class Table, class Info> class ModelPart : public Part<Table> {
public:
    ModelPart() = default;
    explicit ModelPart(const plr_part& part) : Part<Table>(part), info_(this->table_->info(this->self_)) {}
    const Info& info() const noexcept { return *info_; }

private:
    const Info* info_ = nullptr;
};

using MotionPart = ModelPart<plr_motion, plr_motion_info>;
using SensorPart = ModelPart<plr_sensor, plr_sensor_info>;
using EstimatorPart = ModelPart<plr_estimator, plr_estimator_info>;
using ExtentPart = ModelPart<plr_extent, plr_extent_info>;
using PartitionerPart = ModelPart<plr_partitioner, plr_partitioner_info>;
using WaveformPart = ModelPart<plr_waveform, plr_waveform_info>;
using TrajectoryPart = ModelPart<plr_trajectory, plr_trajectory_info>;

/// An argument struct with its size set and everything else zero.
template <class Args> Args arguments() noexcept {
    Args args{};
    args.struct_size = sizeof(Args);
    return args;
}

/// The context for items first .. of a batch.
inline plr_call slice(const plr_call& call, std::int64_t first) noexcept {
    plr_call part = call;
    part.item_offset += first;
    if (part.item_ids != nullptr) part.item_ids += first;
    if (part.keys != nullptr) part.keys += first;
    if (part.inputs != nullptr) part.inputs += first * part.input_stride;
    if (part.item_status != nullptr) part.item_status += first;
    return part;
}

/// Doubles from the scratch of a call; given back when the object dies. Throws Failure(PLR_E_SCRATCH).
class Scratch {
public:
    Scratch(const plr_call& call, std::int64_t doubles) : scratch_(*call.scratch), before_(scratch_.used) {
        const std::uint64_t start = (scratch_.used + 63) / 64 * 64;
        const std::uint64_t bytes = static_cast<std::uint64_t>(doubles) * sizeof(double);
        if (scratch_.data == nullptr || start + bytes > scratch_.size)
            throw Failure(PLR_E_SCRATCH, "needs " + std::to_string(start + bytes) + " bytes of scratch memory, has " +
                                             std::to_string(scratch_.size));
        data_ = reinterpret_cast<double*>(scratch_.data + start);
        scratch_.used = start + bytes;
    }
    ~Scratch() { scratch_.used = before_; }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    double* data() const noexcept { return data_; }

private:
    plr_scratch& scratch_;
    std::uint64_t before_;
    double* data_ = nullptr;
};

}  // namespace pelorus
