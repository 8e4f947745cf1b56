/// Motion models in C++.
///
///     struct Mine : pelorus::Motion<Mine, 6> {
///         static void describe(pelorus::Describe<Mine>& plugin);
///         pelorus::Space space() const;                                     // components, units, priors
///         State propagate(const State& x, const Step& step) const;          // the mean motion
///         Transition jacobian(const State& x, const Step& step) const;      // d propagate / d x
///         Transition noise(const Posterior& posterior, const Step& step) const;
///     };
///
/// Optional members: `static constexpr std::uint32_t flags`; `static constexpr int record_size` with
/// `Record init_record(const State&, const Transition& covariance) const` and
/// `Record advance_record(const State&, const Transition& covariance, const Step&) const`; `Space cartesian_space() const` with
/// `to_cartesian`, `from_cartesian` (see below); `const void* extension(const char*) const`.
/// All of them [worker, concurrent] [hot]. Throw NumericError to fail one item.
#pragma once

#include <cstring>

#include <pelorus/abi/motion.h>
#include <pelorus/plugin.hpp>
#include <pelorus/space.hpp>

namespace pelorus {

/// What a step of a motion knows besides the state.
struct Step {
    double dt = 0;  ///< s
    const double* record = nullptr;
    const double* mean = nullptr;  ///< posterior mean that sigma points are spread about; nullptr: the state itself
    const plr_call* call = nullptr;
    std::int64_t item = 0;
};

namespace detail {

/// Reads the record-related arguments of item i; the record is contiguous by contract (rows x 1, row_stride 1).
inline Step step_of(const plr_call& call, const plr_const_view& dt, const plr_const_view& record, std::int64_t i) {
    Step step;
    step.dt = dt.data == nullptr ? 0.0 : dt.data[i * dt.item_stride];
    step.record = record.data == nullptr ? nullptr : record.data + i * record.item_stride;
    step.call = &call;
    step.item = i;
    return step;
}

/// What noise and its factor are told of item i, but for the extent; not numbers where the model has said that it reads none of
/// it, and not what a call before left on the stack.
template <class Model> typename Model::Posterior posterior_of(const plr_motion_noise& args, std::int64_t i) {
    constexpr int n = Model::state_size;
    typename Model::Posterior posterior;
    if constexpr ((Model::flags & PLR_MOTION_CONSTANT_NOISE) != 0) {
        posterior.mean.setConstant(not_a_number);
        posterior.covariance.setConstant(not_a_number);
        posterior.predicted.setConstant(not_a_number);
    } else {
        posterior.mean = load<n, 1>(args.state, i);
        posterior.covariance = load<n, n>(args.covariance, i);
        posterior.predicted = load<n, 1>(args.predicted, i);
    }
    return posterior;
}

}  // namespace detail

/// Base of motions with N state components; C Cartesian components where the state is not Cartesian itself.
template <class Derived, int N, int C = N> class Motion {
public:
    static constexpr const char* kind = "motion";
    static constexpr const char* table_id = PLR_MOTION;
    static constexpr const char* version = "1.0.0";
    static constexpr std::uint32_t flags = 0;
    static constexpr std::uint32_t record_version = 1;
    static constexpr int record_size = 0;
    static constexpr bool cartesian = true;  ///< false: space() differs from cartesian_space()
    static constexpr int state_size = N;

    using State = Vector<N>;
    using Transition = Matrix<N, N>;
    using Cartesian = Vector<C>;

    /// The posterior that a step starts from.
    struct Posterior {
        State mean;                      ///< not numbers with PLR_MOTION_CONSTANT_NOISE
        Transition covariance;           ///< "
        State predicted;                 ///< "
        const double* extent = nullptr;  ///< d x d, with PLR_MOTION_USES_EXTENT
    };

    /// The value of an input (order of declaration) in this step.
    const double* input(const Step& step, std::size_t index) const noexcept {
        return inputs_(*step.call, step.item, index);
    }
    const void* extension(const char*) const noexcept { return nullptr; }

    void complete(const plr_config& config, const plr_description& description) {
        inputs_.complete(config, description);
        space_ = derived().space();
        expect_size(space_, N, "space()");
        if constexpr (!Derived::cartesian) {
            cartesian_ = derived().cartesian_space();
            expect_size(cartesian_, C, "cartesian_space()");
        }
        for (const Component& component : (Derived::cartesian ? space_ : cartesian_).components())
            axes_ += component.name.rfind("position.", 0) == 0;
        info_ = {sizeof(plr_motion_info),
                 Derived::flags,
                 space_.c(),
                 Derived::cartesian ? space_.c() : cartesian_.c(),
                 Derived::record_size,
                 Derived::record_version,
                 0,
                 0};
    }

    static const plr_motion& table() noexcept {
        static constexpr plr_motion t{{sizeof(plr_motion), 0, &detail::destroy<Derived>, &extension_entry},
                                      &info_entry,
                                      &propagate_entry,
                                      &jacobian_entry,
                                      &noise_entry,
                                      Derived::record_size > 0 ? &init_record_entry : nullptr,
                                      Derived::record_size > 0 ? &advance_record_entry : nullptr,
                                      Derived::cartesian ? nullptr : &to_cartesian_entry,
                                      Derived::cartesian ? nullptr : &from_cartesian_entry};
        return t;
    }

protected:
    const Derived& derived() const noexcept { return static_cast<const Derived&>(*this); }

private:
    static const Derived& self_of(const void* self) noexcept { return *static_cast<const Derived*>(self); }
    /// What is ours, even where the author's class has a member of the same name.
    static const Motion& base_of(const void* self) noexcept { return self_of(self); }
    static const plr_motion_info* info_entry(const void* self) noexcept { return &base_of(self).info_; }
    static const void* extension_entry(const void* self, const char* id) noexcept {
        return self_of(self).extension(id);
    }

    static void check_step(const plr_const_view& dt, const plr_const_view& record, std::int64_t count) {
        expect(dt, 1, 1, count, "dt");
        if constexpr (Derived::record_size > 0) expect(record, Derived::record_size, 1, count, "record");
    }
    static Step step(const plr_call& call, const plr_const_view& dt, const plr_const_view& record, std::int64_t i) {
        const Step s = detail::step_of(call, dt, record, i);
        if constexpr ((Derived::flags & PLR_MOTION_BACKWARD) == 0)
            if (s.dt < 0) throw UnsupportedError("cannot move backward in time (dt < 0)");
        return s;
    }

    static plr_status propagate_entry(const void* self, const plr_call* call,
                                      const plr_motion_propagate* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            const std::int64_t count = args->out.count, points = args->out.cols;
            check_step(args->dt, args->record, count);
            expect(args->state, N, points, count, "state");
            expect(args->out, N, points, count, "out");
            if (args->mean.data != nullptr) expect(args->mean, N, 1, count, "mean");
            return for_items(*call, count, [&](std::int64_t i) {
                Step s = step(*call, args->dt, args->record, i);
                if (args->mean.data != nullptr) s.mean = args->mean.data + i * args->mean.item_stride;
                for (std::int64_t p = 0; p < points; ++p)
                    store<N, 1>(args->out, i, self_of(self).propagate(load_column<N>(args->state, i, p), s), p);
            });
        });
    }
    static plr_status jacobian_entry(const void* self, const plr_call* call, const plr_motion_jacobian* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            const std::int64_t count = args->out.count;
            check_step(args->dt, args->record, count);
            expect(args->state, N, 1, count, "state");
            expect(args->out, N, N, count, "out");
            if (args->mean.data != nullptr) expect(args->mean, N, 1, count, "mean");
            return for_items(*call, count, [&](std::int64_t i) {
                Step s = step(*call, args->dt, args->record, i);
                if (args->mean.data != nullptr) s.mean = args->mean.data + i * args->mean.item_stride;
                store<N, N>(args->out, i, self_of(self).jacobian(load<N, 1>(args->state, i), s));
            });
        });
    }
    static plr_status noise_entry(const void* self, const plr_call* call, const plr_motion_noise* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            constexpr bool constant = (Derived::flags & PLR_MOTION_CONSTANT_NOISE) != 0;
            const std::int64_t count = args->out.count;
            check_step(args->dt, args->record, count);
            if constexpr (!constant) {
                expect(args->state, N, 1, count, "state");
                expect(args->covariance, N, N, count, "covariance");
                expect(args->predicted, N, 1, count, "predicted");
            }
            if constexpr ((Derived::flags & PLR_MOTION_USES_EXTENT) != 0) {
                const std::int64_t axes = base_of(self).axes_;
                if (args->extent.data == nullptr && count > 0) throw ArgumentError("extent: this motion needs one");
                expect(args->extent, axes, axes, count, "extent");
            }
            expect(args->out, N, N, count, "out");
            return for_items(*call, count, [&](std::int64_t i) {
                Posterior posterior = detail::posterior_of<Derived>(*args, i);
                if constexpr ((Derived::flags & PLR_MOTION_USES_EXTENT) != 0)
                    posterior.extent = args->extent.data + i * args->extent.item_stride;
                const Step s = step(*call, args->dt, args->record, i);
                store<N, N>(args->out, i, self_of(self).noise(posterior, s));
            });
        });
    }
    static plr_status init_record_entry(const void* self, const plr_call* call,
                                        const plr_motion_record* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            constexpr int size = Derived::record_size;
            if constexpr (size > 0) {
                expect(args->state, N, 1, args->out.count, "state");
                expect(args->covariance, N, N, args->out.count, "covariance");
                expect(args->out, size, 1, args->out.count, "out");
                return for_items(*call, args->out.count, [&](std::int64_t i) {
                    const Vector<size> record =
                        self_of(self).init_record(load<N, 1>(args->state, i), load<N, N>(args->covariance, i));
                    store<size, 1>(args->out, i, record);
                });
            }
            return PLR_E_UNSUPPORTED;
        });
    }
    static plr_status advance_record_entry(const void* self, const plr_call* call,
                                           const plr_motion_record* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            constexpr int size = Derived::record_size;
            if constexpr (size > 0) {
                check_step(args->dt, args->record, args->out.count);
                expect(args->state, N, 1, args->out.count, "state");
                expect(args->covariance, N, N, args->out.count, "covariance");
                expect(args->out, size, 1, args->out.count, "out");
                return for_items(*call, args->out.count, [&](std::int64_t i) {
                    const Step s = step(*call, args->dt, args->record, i);
                    const Vector<size> record =
                        self_of(self).advance_record(load<N, 1>(args->state, i), load<N, N>(args->covariance, i), s);
                    store<size, 1>(args->out, i, record);
                });
            }
            return PLR_E_UNSUPPORTED;
        });
    }
    /// Cartesian to_cartesian(const State&) const;  Matrix<C, N> to_cartesian_jacobian(const State&) const.
    static plr_status to_cartesian_entry(const void* self, const plr_call* call,
                                         const plr_motion_convert* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            if constexpr (!Derived::cartesian) {
                const std::int64_t points = args->out.cols;
                expect(args->in, N, points, args->out.count, "in");
                expect(args->out, C, points, args->out.count, "out");
                if (args->jacobian.data != nullptr) expect(args->jacobian, C, N, args->out.count, "jacobian");
                return for_items(*call, args->out.count, [&](std::int64_t i) {
                    for (std::int64_t p = 0; p < points; ++p)
                        store<C, 1>(args->out, i, self_of(self).to_cartesian(load_column<N>(args->in, i, p)), p);
                    if (args->jacobian.data != nullptr)
                        store<C, N>(args->jacobian, i,
                                    self_of(self).to_cartesian_jacobian(load_column<N>(args->in, i, 0)));
                });
            }
            return PLR_E_UNSUPPORTED;
        });
    }
    /// State from_cartesian(const Cartesian&) const;  Matrix<N, C> from_cartesian_jacobian(const Cartesian&) const.
    static plr_status from_cartesian_entry(const void* self, const plr_call* call,
                                           const plr_motion_convert* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            if constexpr (!Derived::cartesian) {
                const std::int64_t points = args->out.cols;
                expect(args->in, C, points, args->out.count, "in");
                expect(args->out, N, points, args->out.count, "out");
                if (args->jacobian.data != nullptr) expect(args->jacobian, N, C, args->out.count, "jacobian");
                return for_items(*call, args->out.count, [&](std::int64_t i) {
                    for (std::int64_t p = 0; p < points; ++p)
                        store<N, 1>(args->out, i, self_of(self).from_cartesian(load_column<C>(args->in, i, p)), p);
                    if (args->jacobian.data != nullptr)
                        store<N, C>(args->jacobian, i,
                                    self_of(self).from_cartesian_jacobian(load_column<C>(args->in, i, 0)));
                });
            }
            return PLR_E_UNSUPPORTED;
        });
    }

    InputTable inputs_;
    Space space_, cartesian_;
    std::int64_t axes_ = 0;  ///< d of an extent: Cartesian positions
    plr_motion_info info_{};
};

/// Linear motions that act alike on every axis: F = F1 (x) I_D, Q = Q1 (x) I_D, with B derivatives (position first).
/// The author gives the small matrices; the full ones, and the extension that lets estimators exploit the structure, follow.
///
///     Block transition(double dt) const;   Block noise_block(double dt) const;   std::vector<double> priors() const;
template <class Derived, int B, int D> class KroneckerMotion : public Motion<Derived, B * D> {
public:
    static constexpr std::uint32_t flags = PLR_MOTION_LINEAR | PLR_MOTION_CONSTANT_NOISE;
    using Block = Matrix<B, B>;
    using typename Motion<Derived, B * D>::State;
    using typename Motion<Derived, B * D>::Transition;
    using typename Motion<Derived, B * D>::Posterior;

    Space space() const { return kinematic_space(D, this->derived().priors()); }

    State propagate(const State& x, const Step& step) const {
        const Block f = this->derived().transition(step.dt);
        State out = State::Zero();
        for (int r = 0; r < B; ++r)
            for (int c = 0; c < B; ++c)
                for (int axis = 0; axis < D; ++axis) out(r * D + axis) += f(r, c) * x(c * D + axis);
        return out;
    }
    Transition jacobian(const State&, const Step& step) const { return spread(this->derived().transition(step.dt)); }
    Transition noise(const Posterior&, const Step& step) const { return spread(this->derived().noise_block(step.dt)); }

    const void* extension(const char* id) const noexcept {
        static constexpr plr_motion_structure structure{sizeof(plr_motion_structure), B, D, 0, &blocks_entry};
        return std::strcmp(id, PLR_MOTION_STRUCTURE) == 0 ? &structure : nullptr;
    }

private:
    static Transition spread(const Block& block) {
        Transition full = Transition::Zero();
        for (int r = 0; r < B; ++r)
            for (int c = 0; c < B; ++c)
                for (int axis = 0; axis < D; ++axis) full(r * D + axis, c * D + axis) = block(r, c);
        return full;
    }
    static plr_status blocks_entry(const void* self, const plr_call* call, double dt, double* f1, double* q1) noexcept {
        return guarded(call->error, [&] {
            const auto& model = *static_cast<const Derived*>(self);
            if constexpr ((Derived::flags & PLR_MOTION_BACKWARD) == 0)
                if (dt < 0) throw UnsupportedError("cannot move backward in time (dt < 0)");
            store<B, B>(view(f1, B, B, 1), 0, model.transition(dt));
            store<B, B>(view(q1, B, B, 1), 0, model.noise_block(dt));
        });
    }
};

}  // namespace pelorus
