/// motion.composite: motions side by side, each over components of its own. See README.md.
#pragma once

#include <optional>

#include <pelorus/motion.hpp>

#include "joined_space.hpp"

namespace composite {

enum class Axes { x, y, z, xy, xz, yz, xyz };

/// What the config says of a part beside its own parameters.
struct PartValues {
    std::optional<Axes> axes;
};

/// A motion whose size is known when it is made: it fills the call table by itself. All calls work in blocks of items (and of
/// points) in scratch memory, where each part finds its own rows packed.
class Composite {
public:
    static constexpr const char* kind = "motion";
    static constexpr const char* table_id = PLR_MOTION;
    static constexpr const char* version = "1.0.0";

    static void describe(pelorus::Describe<Composite>& plugin);
    static const plr_description* description(const char* id) { return pelorus::Describe<Composite>::of(id).c(); }
    static plr_instance create(const pelorus::Setup& setup);

    explicit Composite(const pelorus::Setup& setup);

    const plr_motion_info* info() const noexcept { return &info_; }
    const void* extension(const char* id) const noexcept;
    plr_status propagate(const plr_call& call, const plr_motion_propagate& args) const;
    plr_status jacobian(const plr_call& call, const plr_motion_jacobian& args) const;
    plr_status noise(const plr_call& call, const plr_motion_noise& args) const;
    plr_status noise_factor(const plr_call& call, const plr_motion_noise& args) const;
    plr_status init_record(const plr_call& call, const plr_motion_record& args) const;
    plr_status advance_record(const plr_call& call, const plr_motion_record& args) const;

private:
    /// Names the row and the column of the whole for each row and column of a part: all columns as they are where `columns` is null.
    struct Rows {
        const std::vector<int>& rows;
        const std::vector<int>* columns = nullptr;
    };
    static plr_const_view gather(const plr_const_view& whole, const Rows& rows, double* to);
    static void scatter(const plr_const_view& part, const Rows& rows, std::int64_t first_column, const plr_view& whole);
    static void clear(const plr_view& whole);
    bool has(std::uint32_t flag) const noexcept { return (info_.flags & flag) != 0; }
    plr_const_view record_of(const Member& member, const plr_const_view& records) const noexcept;
    void set_info();
    void expect_step(const plr_const_view& dt, const plr_const_view& record, std::int64_t count) const;
    void expect_noise(const plr_motion_noise& args, std::int64_t columns) const;
    plr_status propagate_points(const plr_call& call, const plr_motion_propagate& args) const;
    /// Posterior and predicted mean of one member's components.
    void give_posterior(const Member& member, const plr_motion_noise& from, plr_motion_noise& to, double* memory) const;
    plr_status record_call(const plr_call& call, const plr_motion_record& args,
                           plr_status (*plr_motion::*function)(const void*, const plr_call*,
                                                               const plr_motion_record*)) const;

    std::vector<Member> members_;
    pelorus::Space space_;
    plr_motion_info info_{};
    plr_motion_noise_factor factor_{};
    std::int64_t n_ = 0, largest_ = 0;  // components of the whole and of the largest part
};

}  // namespace composite
