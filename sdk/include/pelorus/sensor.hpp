/// Sensor models in C++.
///
///     struct Mine : pelorus::Sensor<Mine, 3, 3> {                           // M measurement, C Cartesian components
///         static void describe(pelorus::Describe<Mine>& plugin);
///         pelorus::Space measurement_space() const;
///         pelorus::Space cartesian_space() const;                           // what measure reads
///         Measurement measure(const Cartesian& x, const Look& look) const;
///         Jacobian jacobian(const Cartesian& x, const Look& look) const;
///         Noise noise(const Query& query, const Look& look) const;
///     };
///
/// Optional members: `static constexpr std::uint32_t flags`; with PLR_SENSOR_CAN_INVERT and a 4th template argument, the number of
/// components that a measurement determines (`Sensor<Mine, 3, 4, 2>`; else C): `Space inverse_space() const` and `Inverse invert(const Measurement&, const Noise&, const Look&) const`; with
/// PLR_SENSOR_WAVEFORM: `Space waveform_space() const`; `Measurement residual(const Measurement&, const Measurement&) const`
/// (by default angles, as marked in the space, are wrapped); `const void* extension(const char*) const`; where parameters or
/// slots decide what an instance promises, `std::uint32_t instance_flags() const`: those of `flags` that hold for it (all but
/// PLR_SENSOR_CAN_INVERT may be missing); where it calls parts, `std::uint64_t scratch_bytes() const`: what these need.
/// All of them [worker, concurrent] [hot]. Throw NumericError to fail one item.
#pragma once

#include <array>
#include <cmath>

#include <pelorus/abi/sensor.h>
#include <pelorus/plugin.hpp>
#include <pelorus/space.hpp>

namespace pelorus {

/// An angle in (-pi, pi].
inline double wrap_angle(double angle) noexcept {
    constexpr double pi = 3.14159265358979323846;
    if (angle > -pi && angle <= pi) return angle;
    const double wrapped = std::remainder(angle, 2 * pi);
    return wrapped <= -pi ? pi : wrapped;
}

/// What accompanies one look of a sensor.
struct Look {
    const plr_call* call = nullptr;
    std::int64_t item = 0;
};

template <class Derived, int M, int C, int I = C> class Sensor {
public:
    static constexpr const char* kind = "sensor";
    static constexpr const char* table_id = PLR_SENSOR;
    static constexpr const char* version = "1.0.0";
    static constexpr std::uint32_t flags = 0;
    static constexpr int measurement_size = M, cartesian_size = C, inverse_size = I;

    using Measurement = Vector<M>;
    using Cartesian = Vector<C>;
    using Jacobian = Matrix<M, C>;
    using Noise = Matrix<M, M>;

    /// What noise may depend on.
    struct Query {
        Cartesian cartesian;               ///< not numbers with PLR_SENSOR_CONSTANT_NOISE
        const double* snr = nullptr;       ///< power ratio, or nullptr: nominal
        const double* waveform = nullptr;  ///< parameters in force, or nullptr: base waveform
    };
    struct Inverse {
        Vector<I> mean;
        Matrix<I, I> covariance;
    };

    /// The value of an input (order of declaration) in this look.
    const double* input(const Look& look, std::size_t index) const noexcept {
        return inputs_(*look.call, look.item, index);
    }
    const void* extension(const char*) const noexcept { return nullptr; }
    std::uint32_t instance_flags() const noexcept { return Derived::flags; }
    std::uint64_t scratch_bytes() const noexcept { return 0; }

    Measurement residual(const Measurement& measurement, const Measurement& reference) const noexcept {
        Measurement difference;
        for (int r = 0; r < M; ++r) {
            difference(r) = measurement(r) - reference(r);
            if (angle_[static_cast<std::size_t>(r)]) difference(r) = wrap_angle(difference(r));
        }
        return difference;
    }

    void complete(const plr_config& config, const plr_description& description) {
        inputs_.complete(config, description);
        measurement_ = derived().measurement_space();
        cartesian_ = derived().cartesian_space();
        expect_size(measurement_, M, "measurement_space()");
        expect_size(cartesian_, C, "cartesian_space()");
        for (int r = 0; r < M; ++r) angle_[static_cast<std::size_t>(r)] = measurement_[r].angle;
        const plr_space* inverse = nullptr;
        const plr_space* waveform = nullptr;
        if constexpr ((Derived::flags & PLR_SENSOR_CAN_INVERT) != 0) {
            inverse_ = derived().inverse_space();
            expect_size(inverse_, Derived::inverse_size, "inverse_space()");
            inverse = inverse_.c();
        }
        const std::uint32_t own_flags = derived().instance_flags();
        if constexpr ((Derived::flags & PLR_SENSOR_WAVEFORM) != 0) {
            if ((own_flags & PLR_SENSOR_WAVEFORM) != 0) {
                waveform_ = derived().waveform_space();
                waveform = waveform_.c();
            }
        }
        info_ = {sizeof(plr_sensor_info),  own_flags, measurement_.c(), cartesian_.c(), inverse, waveform,
                 derived().scratch_bytes()};
    }

    static const plr_sensor& table() noexcept {
        static constexpr plr_sensor t{{sizeof(plr_sensor), 0, &detail::destroy<Derived>, &extension_entry},
                                      &info_entry,
                                      &measure_entry,
                                      &jacobian_entry,
                                      &noise_entry,
                                      &residual_entry,
                                      (Derived::flags & PLR_SENSOR_CAN_INVERT) != 0 ? &invert_entry : nullptr};
        return t;
    }

protected:
    const Derived& derived() const noexcept { return static_cast<const Derived&>(*this); }

private:
    static const Derived& self_of(const void* self) noexcept { return *static_cast<const Derived*>(self); }
    /// What is ours, even where the author's class has a member of the same name.
    static const Sensor& base_of(const void* self) noexcept { return self_of(self); }
    static const plr_sensor_info* info_entry(const void* self) noexcept { return &base_of(self).info_; }
    static const void* extension_entry(const void* self, const char* id) noexcept {
        return self_of(self).extension(id);
    }

    static plr_status measure_entry(const void* self, const plr_call* call, const plr_sensor_measure* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            const std::int64_t count = args->out.count, points = args->out.cols;
            expect(args->cartesian, C, points, count, "cartesian");
            expect(args->out, M, points, count, "out");
            return for_items(*call, count, [&](std::int64_t i) {
                for (std::int64_t p = 0; p < points; ++p)
                    store<M, 1>(args->out, i,
                                self_of(self).measure(load_column<C>(args->cartesian, i, p), Look{call, i}), p);
            });
        });
    }
    static plr_status jacobian_entry(const void* self, const plr_call* call, const plr_sensor_jacobian* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            const std::int64_t count = args->out.count;
            expect(args->cartesian, C, 1, count, "cartesian");
            expect(args->out, M, C, count, "out");
            return for_items(*call, count, [&](std::int64_t i) {
                store<M, C>(args->out, i, self_of(self).jacobian(load<C, 1>(args->cartesian, i), Look{call, i}));
            });
        });
    }
    static plr_status noise_entry(const void* self, const plr_call* call, const plr_sensor_noise* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            const bool constant = (base_of(self).info_.flags & PLR_SENSOR_CONSTANT_NOISE) != 0;
            const std::int64_t count = args->out.count;
            if (!constant) expect(args->cartesian, C, 1, count, "cartesian");
            if (args->snr.data != nullptr) expect(args->snr, 1, 1, count, "snr");
            if (args->waveform.data != nullptr && (base_of(self).info_.flags & PLR_SENSOR_WAVEFORM) != 0)
                expect(args->waveform, base_of(self).waveform_.size(), 1, count, "waveform");
            expect(args->out, M, M, count, "out");
            return for_items(*call, count, [&](std::int64_t i) {
                Query query;
                if (constant)
                    query.cartesian.setConstant(not_a_number);  // and not what a call before left on the stack
                else
                    query.cartesian = load<C, 1>(args->cartesian, i);
                if (args->snr.data != nullptr) query.snr = args->snr.data + i * args->snr.item_stride;
                if (args->waveform.data != nullptr)
                    query.waveform = args->waveform.data + i * args->waveform.item_stride;
                store<M, M>(args->out, i, self_of(self).noise(query, Look{call, i}));
            });
        });
    }
    static plr_status residual_entry(const void* self, const plr_call* call, const plr_sensor_residual* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            const std::int64_t count = args->out.count, points = args->out.cols, references = args->reference.cols;
            expect(args->measurement, M, points, count, "measurement");
            expect(args->reference, M, references == 1 ? 1 : points, count, "reference");
            expect(args->out, M, points, count, "out");
            return for_items(*call, count, [&](std::int64_t i) {
                for (std::int64_t p = 0; p < points; ++p)
                    store<M, 1>(args->out, i,
                                self_of(self).residual(load_column<M>(args->measurement, i, p),
                                                       load_column<M>(args->reference, i, references == 1 ? 0 : p)),
                                p);
            });
        });
    }
    static plr_status invert_entry(const void* self, const plr_call* call, const plr_sensor_invert* args) noexcept {
        return guarded(call->error, [&]() -> plr_status {
            const std::int64_t count = args->mean.count;
            expect(args->measurement, M, 1, count, "measurement");
            expect(args->noise, M, M, count, "noise");
            expect(args->mean, I, 1, count, "mean");
            if (args->covariance.data != nullptr) expect(args->covariance, I, I, count, "covariance");
            return for_items(*call, count, [&](std::int64_t i) {
                if constexpr ((Derived::flags & PLR_SENSOR_CAN_INVERT) != 0) {
                    const Inverse inverse = self_of(self).invert(load<M, 1>(args->measurement, i),
                                                                 load<M, M>(args->noise, i), Look{call, i});
                    store<I, 1>(args->mean, i, inverse.mean);
                    if (args->covariance.data != nullptr) store<I, I>(args->covariance, i, inverse.covariance);
                }
            });
        });
    }

    InputTable inputs_;
    Space measurement_, cartesian_, inverse_, waveform_;
    std::array<bool, static_cast<std::size_t>(M)> angle_{};
    plr_sensor_info info_{};
};

}  // namespace pelorus
