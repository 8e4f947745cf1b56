/// Bases of the kinds whose authors work on whole batches: estimator, extent, partitioner, waveform, trajectory.
///
/// The member functions take the ABI's argument structs as they are (shapes are documented there) and return nothing, or a
/// plr_status that they got from for_items. Exceptions become status and message. Each class holds its own `info` struct,
/// filled in setup(); the spaces it points to must be members of the class.
#pragma once

#include <pelorus/abi/estimator.h>
#include <pelorus/abi/extent.h>
#include <pelorus/abi/partitioner.h>
#include <pelorus/abi/trajectory.h>
#include <pelorus/abi/waveform.h>
#include <pelorus/plugin.hpp>
#include <pelorus/space.hpp>

namespace pelorus {

namespace detail {

/// An ABI entry that forwards to a const member function of Derived.
template <class Derived, class Args, auto Member>
plr_status forward(const void* self, const plr_call* call, const Args* args) noexcept {
    return guarded(call->error, [&] { return (static_cast<const Derived*>(self)->*Member)(*call, *args); });
}

}  // namespace detail

/// What the batch kinds share. `info` is theirs to fill in setup(); struct_size is set already.
template <class Derived, class Info> class BatchModel {
public:
    static constexpr const char* version = "1.0.0";
    const void* extension(const char*) const noexcept { return nullptr; }
    void complete(const plr_config& config, const plr_description& description) {
        inputs.complete(config, description);
    }

protected:
    static const Info* info_entry(const void* self) noexcept { return &static_cast<const Derived*>(self)->info; }
    static const void* extension_entry(const void* self, const char* id) noexcept {
        return static_cast<const Derived*>(self)->extension(id);
    }
    static constexpr plr_table_head head(std::uint32_t size) noexcept {
        return {size, 0, &detail::destroy<Derived>, &extension_entry};
    }

public:
    Info info = [] {
        Info blank{};
        blank.struct_size = sizeof(Info);
        return blank;
    }();
    InputTable inputs;
};

/// Members of Derived: init, predict, project, update, summary, moments; with PLR_ESTIMATOR_ASSIGNABLE (static flag
/// `assignable`) assign. Each `R name(const plr_call&, const plr_estimator_NAME&) const`.
template <class Derived> class Estimator : public BatchModel<Derived, plr_estimator_info> {
public:
    static constexpr const char* kind = "estimator";
    static constexpr const char* table_id = PLR_ESTIMATOR;
    static constexpr bool assignable = true;

    static const plr_estimator& table() noexcept {
        static constexpr plr_estimator t = [] {
            plr_estimator e{Estimator::head(sizeof(plr_estimator)),
                            &Estimator::info_entry,
                            &detail::forward<Derived, plr_estimator_init, &Derived::init>,
                            &detail::forward<Derived, plr_estimator_predict, &Derived::predict>,
                            &detail::forward<Derived, plr_estimator_project, &Derived::project>,
                            &detail::forward<Derived, plr_estimator_update, &Derived::update>,
                            &detail::forward<Derived, plr_estimator_moments, &Derived::summary>,
                            &detail::forward<Derived, plr_estimator_moments, &Derived::moments>,
                            nullptr};
            if constexpr (Derived::assignable)
                e.assign = &detail::forward<Derived, plr_estimator_assign, &Derived::assign>;
            return e;
        }();
        return t;
    }
};

/// Members of Derived: shape; unless `static constexpr bool joint = true`: init, predict, effective_noise, update, gate.
/// A joint extent answers extension(PLR_EXTENT_JOINT) with joint_table(), whose functions are its members joint_init,
/// joint_predict, joint_update, joint_summary, joint_gate. A class that can be both is two classes behind a create().
template <class Derived> class Extent : public BatchModel<Derived, plr_extent_info> {
public:
    static constexpr const char* kind = "extent";
    static constexpr const char* table_id = PLR_EXTENT;
    static constexpr bool joint = false;

    static const plr_extent& table() noexcept {
        static constexpr plr_extent t = [] {
            plr_extent e{Extent::head(sizeof(plr_extent)),
                         &Extent::info_entry,
                         nullptr,
                         nullptr,
                         nullptr,
                         nullptr,
                         &detail::forward<Derived, plr_extent_shape, &Derived::shape>,
                         nullptr};
            if constexpr (!Derived::joint) {
                e.init = &detail::forward<Derived, plr_extent_init, &Derived::init>;
                e.predict = &detail::forward<Derived, plr_extent_predict, &Derived::predict>;
                e.effective_noise = &detail::forward<Derived, plr_extent_effective_noise, &Derived::effective_noise>;
                e.update = &detail::forward<Derived, plr_extent_update, &Derived::update>;
                e.gate = &detail::forward<Derived, plr_extent_gate, &Derived::gate>;
            }
            return e;
        }();
        return t;
    }
    /// The extension's table; what it points to lives as long as the instance.
    static plr_extent_joint joint_table(const plr_space* cartesian, const plr_part* sensors,
                                        std::uint32_t sensor_count) noexcept {
        return {sizeof(plr_extent_joint),
                sensor_count,
                sensors,
                cartesian,
                &detail::forward<Derived, plr_joint_init, &Derived::joint_init>,
                &detail::forward<Derived, plr_joint_predict, &Derived::joint_predict>,
                &detail::forward<Derived, plr_joint_update, &Derived::joint_update>,
                &detail::forward<Derived, plr_joint_summary, &Derived::joint_summary>,
                &detail::forward<Derived, plr_extent_gate, &Derived::joint_gate>};
    }
};

/// Member of Derived: `R split(const plr_call&, const plr_partitioner_split&) const`.
template <class Derived> class Partitioner : public BatchModel<Derived, plr_partitioner_info> {
public:
    static constexpr const char* kind = "partitioner";
    static constexpr const char* table_id = PLR_PARTITIONER;

    static const plr_partitioner& table() noexcept {
        static constexpr plr_partitioner t{Partitioner::head(sizeof(plr_partitioner)), &Partitioner::info_entry,
                                           &detail::forward<Derived, plr_partitioner_split, &Derived::split>};
        return t;
    }
};

/// Members of Derived: `R choose(const plr_call&, const plr_waveform_choose&) const`,
/// `R noise(const plr_call&, const plr_waveform_noise&) const`.
template <class Derived> class Waveform : public BatchModel<Derived, plr_waveform_info> {
public:
    static constexpr const char* kind = "waveform";
    static constexpr const char* table_id = PLR_WAVEFORM;

    static const plr_waveform& table() noexcept {
        static constexpr plr_waveform t{Waveform::head(sizeof(plr_waveform)), &Waveform::info_entry,
                                        &detail::forward<Derived, plr_waveform_choose, &Derived::choose>,
                                        &detail::forward<Derived, plr_waveform_noise, &Derived::noise>};
        return t;
    }
};

/// Members of Derived: `R realise(const plr_call&, const plr_view& record) const`,
/// `R states(const plr_call&, const plr_trajectory_states&) const`.
template <class Derived> class Trajectory : public BatchModel<Derived, plr_trajectory_info> {
public:
    static constexpr const char* kind = "trajectory";
    static constexpr const char* table_id = PLR_TRAJECTORY;

    static const plr_trajectory& table() noexcept {
        static constexpr plr_trajectory t{Trajectory::head(sizeof(plr_trajectory)), &Trajectory::info_entry,
                                          &detail::forward<Derived, plr_view, &Derived::realise>,
                                          &detail::forward<Derived, plr_trajectory_states, &Derived::states>};
        return t;
    }
};

}  // namespace pelorus
