#include "composite.hpp"

#include <algorithm>

#include "../../common/batches/batches.hpp"

namespace composite {

using batches::at;
using batches::block_size;
using pelorus::absent_view;
using pelorus::const_view;
using pelorus::slice;

namespace {

constexpr std::int64_t point_block = 16;
constexpr const char* slot = "motions";
constexpr const char* axes_words[] = {"x", "y", "z", "xy", "xz", "yz", "xyz"};

/// What must hold of every part, for the whole to have it.
constexpr std::uint32_t common_flags = PLR_MOTION_TIME_INVARIANT | PLR_MOTION_EXACT_NOISE | PLR_MOTION_LINEAR |
                                       PLR_MOTION_CONSTANT_NOISE | PLR_MOTION_BACKWARD;

Member member_of(const pelorus::MotionPart& motion) {
    const plr_motion_info& info = motion.info();
    if (motion.table().to_cartesian != nullptr || !pelorus::Space(*info.state).same(pelorus::Space(*info.cartesian)))
        throw pelorus::PartError(slot, motion.address() + " (" + motion.id() + ") has a state that is not Cartesian: " +
                                           pelorus::Space(*info.state).text() +
                                           "; motions are joined by their Cartesian components");
    if ((info.flags & PLR_MOTION_USES_EXTENT) != 0)
        throw pelorus::PartError(slot, motion.address() + " (" + motion.id() +
                                           ") reads the extent, which belongs to the whole target, not to some axes");
    Member member;
    member.motion = motion;
    const auto values = pelorus::Describe<Composite>::of().slot_values<PartValues>(motion.raw());
    if (values.axes) member.axes = axes_words[static_cast<int>(*values.axes)];
    const auto* const factor = motion.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
    member.columns = factor == nullptr ? 0 : factor->columns;
    return member;
}

/// A rows x cols matrix an item in the block's scratch memory.
plr_view place(double*& memory, std::int64_t rows, std::int64_t cols, std::int64_t count) noexcept {
    const plr_view view = pelorus::view(memory, rows, cols, count);
    memory += rows * cols * count;
    return view;
}

/// Items first .. of what noise is told, and of where it answers.
plr_motion_noise block_of(const plr_motion_noise& args, std::int64_t first, std::int64_t items) {
    plr_motion_noise block = args;
    for (plr_const_view* const view : {&block.dt, &block.state, &block.covariance, &block.predicted, &block.record})
        *view = slice(*view, first, items);
    block.out = slice(args.out, first, items);
    return block;
}

}  // namespace

Composite::Composite(const pelorus::Setup& setup) {
    for (const auto& motion : setup.parts<pelorus::MotionPart>(slot)) members_.push_back(member_of(motion));
    space_ = join(members_);
    set_info();
}

void Composite::set_info() {
    n_ = space_.size();
    info_ = {sizeof(plr_motion_info), common_flags, space_.c(), space_.c(), 0, 1, 0, 0};
    std::uint64_t deepest = 0;
    std::int64_t columns = 0;
    bool all_have_factors = true;
    for (Member& member : members_) {
        const plr_motion_info& part = member.motion.info();
        info_.flags &= part.flags | ~common_flags;
        info_.flags |= part.flags & PLR_FLAG_USES_KEYS;
        member.record = info_.record_size;
        info_.record_size += part.record_size;
        info_.record_version = plr_mix_version(info_.record_version, part.record_version);
        largest_ = std::max<std::int64_t>(largest_, part.state->size);
        deepest = std::max(deepest, part.scratch_bytes);
        all_have_factors = all_have_factors && member.columns > 0;
        columns += member.columns;
    }
    // The largest need of a call: noise, with a state, a covariance, a predicted state and a result; or points in and out.
    const std::int64_t noise = 2 * largest_ * largest_ + 2 * largest_, points = 2 * largest_ * point_block + largest_;
    info_.scratch_bytes =
        static_cast<std::uint64_t>(block_size * std::max(noise, points)) * sizeof(double) + 128 + deepest;
    if (!all_have_factors) return;
    factor_ = {sizeof(plr_motion_noise_factor), static_cast<std::int32_t>(columns),
               [](const void* self, const plr_call* call, const plr_motion_noise* args) noexcept -> plr_status {
                   return pelorus::guarded(
                       call->error, [&] { return static_cast<const Composite*>(self)->noise_factor(*call, *args); });
               }};
}

const void* Composite::extension(const char* id) const noexcept {
    return factor_.columns > 0 && std::strcmp(id, PLR_MOTION_NOISE_FACTOR) == 0 ? &factor_ : nullptr;
}

plr_const_view Composite::gather(const plr_const_view& whole, const Rows& rows, double* to) {
    const auto height = static_cast<std::int64_t>(rows.rows.size());
    const std::int64_t width = rows.columns == nullptr ? whole.cols : static_cast<std::int64_t>(rows.columns->size());
    double* out = to;
    for (std::int64_t i = 0; i < whole.count; ++i) {
        for (std::int64_t c = 0; c < width; ++c) {
            const std::int64_t from = rows.columns == nullptr ? c : (*rows.columns)[static_cast<std::size_t>(c)];
            const double* const column = at(whole, i) + from * whole.col_stride;
            for (const int row : rows.rows) *out++ = column[row];
        }
    }
    return const_view(to, height, width, whole.count);
}

void Composite::scatter(const plr_const_view& part, const Rows& rows, std::int64_t first_column,
                        const plr_view& whole) {
    const double* in = part.data;
    for (std::int64_t i = 0; i < part.count; ++i) {
        for (std::int64_t c = 0; c < part.cols; ++c) {
            const std::int64_t to =
                rows.columns == nullptr ? first_column + c : (*rows.columns)[static_cast<std::size_t>(c)];
            double* const column = at(whole, i) + to * whole.col_stride;
            for (const int row : rows.rows) column[row] = *in++;
        }
    }
}

void Composite::clear(const plr_view& whole) {
    for (std::int64_t i = 0; i < whole.count; ++i)
        for (std::int64_t c = 0; c < whole.cols; ++c) std::fill_n(at(whole, i) + c * whole.col_stride, whole.rows, 0.0);
}

plr_const_view Composite::record_of(const Member& member, const plr_const_view& records) const noexcept {
    const std::int64_t size = member.motion.info().record_size;
    return size == 0 ? absent_view() : batches::field(records, member.record, size, 1);
}

void Composite::expect_step(const plr_const_view& dt, const plr_const_view& record, std::int64_t count) const {
    pelorus::expect(dt, 1, 1, count, "dt");
    if (info_.record_size > 0) batches::expect_packed(record, info_.record_size, 1, count, "record");
}

plr_status Composite::propagate(const plr_call& call, const plr_motion_propagate& args) const {
    const std::int64_t count = args.out.count, points = args.out.cols;
    expect_step(args.dt, args.record, count);
    batches::expect_packed(args.state, n_, points, count, "state");
    batches::expect_packed(args.out, n_, points, count, "out");
    if (args.mean.data != nullptr) batches::expect_packed(args.mean, n_, 1, count, "mean");
    return batches::in_blocks(call, count, [&](const plr_call& here, std::int64_t first, std::int64_t items) {
        plr_motion_propagate block = args;
        block.dt = slice(args.dt, first, items);
        block.record = slice(args.record, first, items);
        block.mean = slice(args.mean, first, items);
        plr_status result = PLR_OK;
        for (std::int64_t p = 0; p < points; p += point_block) {
            block.state = slice(args.state, first, items);
            block.out = slice(args.out, first, items);
            block.state.data += p * block.state.col_stride;
            block.out.data += p * block.out.col_stride;
            block.state.cols = block.out.cols = std::min(point_block, points - p);
            const plr_status status = propagate_points(here, block);
            if (status < 0) return status;
            if (status != PLR_OK) result = status;
        }
        return result;
    });
}

plr_status Composite::propagate_points(const plr_call& call, const plr_motion_propagate& args) const {
    const std::int64_t count = args.out.count, points = args.out.cols;
    plr_status result = PLR_OK;
    for (const Member& member : members_) {
        const auto n = static_cast<std::int64_t>(member.places.size());
        const pelorus::Scratch scratch(call, count * n * (2 * points + 1));
        double* memory = scratch.data();
        const Rows rows{member.places};
        plr_motion_propagate part = args;
        part.state = gather(args.state, rows, place(memory, n, points, count).data);
        part.mean =
            args.mean.data == nullptr ? absent_view() : gather(args.mean, rows, place(memory, n, 1, count).data);
        part.record = record_of(member, args.record);
        part.out = place(memory, n, points, count);
        const plr_status status = member.motion.call(&plr_motion::propagate, call, part);
        if (status < 0) return status;
        if (status != PLR_OK) result = status;
        scatter(pelorus::as_const(part.out), rows, 0, args.out);
    }
    return result;
}

plr_status Composite::jacobian(const plr_call& call, const plr_motion_jacobian& args) const {
    expect_step(args.dt, args.record, args.out.count);
    batches::expect_packed(args.state, n_, 1, args.out.count, "state");
    batches::expect_packed(args.out, n_, n_, args.out.count, "out");
    if (args.mean.data != nullptr) batches::expect_packed(args.mean, n_, 1, args.out.count, "mean");
    return batches::in_blocks(call, args.out.count, [&](const plr_call& here, std::int64_t first, std::int64_t items) {
        const plr_view out = slice(args.out, first, items);
        clear(out);
        plr_status result = PLR_OK;
        for (const Member& member : members_) {
            const auto n = static_cast<std::int64_t>(member.places.size());
            const pelorus::Scratch scratch(here, items * n * (n + 2));
            double* memory = scratch.data();
            const Rows rows{member.places}, both{member.places, &member.places};
            plr_motion_jacobian part = args;
            part.dt = slice(args.dt, first, items);
            part.state = gather(slice(args.state, first, items), rows, place(memory, n, 1, items).data);
            part.mean = args.mean.data == nullptr
                            ? absent_view()
                            : gather(slice(args.mean, first, items), rows, place(memory, n, 1, items).data);
            part.record = record_of(member, slice(args.record, first, items));
            part.out = place(memory, n, n, items);
            const plr_status status = member.motion.call(&plr_motion::jacobian, here, part);
            if (status < 0) return status;
            if (status != PLR_OK) result = status;
            scatter(pelorus::as_const(part.out), both, 0, out);
        }
        return result;
    });
}

void Composite::expect_noise(const plr_motion_noise& args, std::int64_t columns) const {
    const std::int64_t count = args.out.count;
    expect_step(args.dt, args.record, count);
    if (!has(PLR_MOTION_CONSTANT_NOISE)) {
        batches::expect_packed(args.state, n_, 1, count, "state");
        batches::expect_packed(args.covariance, n_, n_, count, "covariance");
        batches::expect_packed(args.predicted, n_, 1, count, "predicted");
    }
    batches::expect_packed(args.out, n_, columns, count, "out");
}

void Composite::give_posterior(const Member& member, const plr_motion_noise& from, plr_motion_noise& to,
                               double* memory) const {
    to.state = to.covariance = to.predicted = to.extent = absent_view();
    to.dt = from.dt;
    to.record = record_of(member, from.record);
    if ((member.motion.info().flags & PLR_MOTION_CONSTANT_NOISE) != 0) return;
    const auto n = static_cast<std::int64_t>(member.places.size());
    const Rows rows{member.places}, both{member.places, &member.places};
    to.state = gather(from.state, rows, place(memory, n, 1, from.out.count).data);
    to.covariance = gather(from.covariance, both, place(memory, n, n, from.out.count).data);
    to.predicted = gather(from.predicted, rows, place(memory, n, 1, from.out.count).data);
}

plr_status Composite::noise(const plr_call& call, const plr_motion_noise& args) const {
    expect_noise(args, n_);
    return batches::in_blocks(call, args.out.count, [&](const plr_call& here, std::int64_t first, std::int64_t items) {
        const plr_motion_noise block = block_of(args, first, items);
        clear(block.out);
        plr_status result = PLR_OK;
        for (const Member& member : members_) {
            const auto n = static_cast<std::int64_t>(member.places.size());
            const pelorus::Scratch scratch(here, items * n * (2 * n + 2));
            double* memory = scratch.data();
            plr_motion_noise part = args;
            part.out = place(memory, n, n, items);
            give_posterior(member, block, part, memory);
            const plr_status status = member.motion.call(&plr_motion::noise, here, part);
            if (status < 0) return status;
            if (status != PLR_OK) result = status;
            scatter(pelorus::as_const(part.out), {member.places, &member.places}, 0, block.out);
        }
        return result;
    });
}

plr_status Composite::noise_factor(const plr_call& call, const plr_motion_noise& args) const {
    expect_noise(args, factor_.columns);
    return batches::in_blocks(call, args.out.count, [&](const plr_call& here, std::int64_t first, std::int64_t items) {
        const plr_motion_noise block = block_of(args, first, items);
        clear(block.out);
        plr_status result = PLR_OK;
        std::int64_t column = 0;
        for (const Member& member : members_) {
            const auto n = static_cast<std::int64_t>(member.places.size());
            const pelorus::Scratch scratch(here, items * n * (member.columns + n + 2));
            double* memory = scratch.data();
            plr_motion_noise part = args;
            part.out = place(memory, n, member.columns, items);
            give_posterior(member, block, part, memory);
            const auto& extension = *member.motion.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
            const plr_status status = extension.factor(member.motion.self(), &here, &part);
            if (status < 0) return status;
            if (status != PLR_OK) result = status;
            scatter(pelorus::as_const(part.out), {member.places}, column, block.out);
            column += member.columns;
        }
        return result;
    });
}

plr_status Composite::record_call(const plr_call& call, const plr_motion_record& args,
                                  plr_status (*plr_motion::*function)(const void*, const plr_call*,
                                                                      const plr_motion_record*)) const {
    const std::int64_t count = args.out.count;
    batches::expect_packed(args.state, n_, 1, count, "state");
    batches::expect_packed(args.covariance, n_, n_, count, "covariance");
    batches::expect_packed(args.out, info_.record_size, 1, count, "out");
    return batches::in_blocks(call, count, [&](const plr_call& here, std::int64_t first, std::int64_t items) {
        plr_status result = PLR_OK;
        for (const Member& member : members_) {
            const plr_motion_info& info = member.motion.info();
            if (info.record_size == 0) continue;
            const auto n = static_cast<std::int64_t>(member.places.size());
            const pelorus::Scratch scratch(here, items * n * (n + 1));
            double* memory = scratch.data();
            const Rows rows{member.places}, both{member.places, &member.places};
            plr_motion_record part = args;
            part.dt = slice(args.dt, first, items);
            part.state = gather(slice(args.state, first, items), rows, place(memory, n, 1, items).data);
            part.covariance = gather(slice(args.covariance, first, items), both, place(memory, n, n, items).data);
            part.record =
                args.record.data == nullptr ? absent_view() : record_of(member, slice(args.record, first, items));
            part.out = batches::field(slice(args.out, first, items), member.record, info.record_size, 1);
            const plr_status status = member.motion.call(function, here, part);
            if (status < 0) return status;
            if (status != PLR_OK) result = status;
        }
        return result;
    });
}

plr_status Composite::init_record(const plr_call& call, const plr_motion_record& args) const {
    return record_call(call, args, &plr_motion::init_record);
}

plr_status Composite::advance_record(const plr_call& call, const plr_motion_record& args) const {
    expect_step(args.dt, args.record, args.out.count);
    return record_call(call, args, &plr_motion::advance_record);
}

}  // namespace composite
