/// What sensors on a mount have in common: pose, bias, noise. A sensor adds what it sees along its own axes.
///
///     struct Mine : sensing::MountedSensor<Mine, 3, 2, true> {       // M measured, in the plane (2) or in space (3), rates
///         static constexpr std::uint32_t flags = sensing::mounted_flags | PLR_SENSOR_CAN_INVERT;
///         static void describe(pelorus::Describe<Mine>& plugin);      // calls describe_common
///         pelorus::Space measurement_space() const;
///         Measurement seen(const Cartesian& local) const;             // of an object at `local`, along the sensor's axes
///         Jacobian slope(const Cartesian& local) const;               // d seen / d local
///         Inverse converted(const Measurement& z, const Noise& noise) const;   // with CAN_INVERT: position along these axes
///     };
///
///     z = seen(R' (p - m), R' (v - u)) + bias + noise      m, u, R: the mount's position, velocity, rotation
#pragma once

#include <string>
#include <vector>

#include <pelorus/sensor.hpp>

#include "mount.hpp"
#include "noise_law.hpp"

namespace sensing {

constexpr std::uint32_t mounted_flags = PLR_SENSOR_CONSTANT_NOISE | PLR_SENSOR_WAVEFORM;

template <class Derived, int M, int D, bool Rates = false>
struct MountedSensor : pelorus::Sensor<Derived, M, Rates ? 2 * D : D, D>, MountParameters<D>, NoiseParameters<M> {
    using Base = pelorus::Sensor<Derived, M, Rates ? 2 * D : D, D>;
    using typename Base::Cartesian;
    using typename Base::Inverse;
    using typename Base::Jacobian;
    using typename Base::Measurement;
    using typename Base::Noise;
    using typename Base::Query;
    using Look = pelorus::Look;
    /// Where this measurement begins within the input `bias`, in a plugin whose variants share one description.
    static constexpr int bias_offset = 0;

    /// Parameters, inputs and slot. `components` names what `noise` and `bias` have, in order.
    static void describe_common(pelorus::Describe<Derived>& plugin, const char* units, const char* noise,
                                const char* components) {
        NoiseParameters<M>::describe_noise(plugin, units, noise, components);
        describe_inputs(plugin, units, M, components);
    }
    /// The mount's parameters and all inputs; the bias has `size` values.
    static void describe_inputs(pelorus::Describe<Derived>& plugin, const char* units, std::size_t size,
                                const char* components) {
        plugin.input("bias", units, std::vector<double>(size, 0.0), std::string("added to ") + components);
        MountParameters<D>::describe_mount(plugin, Rates);
    }

    void setup(const pelorus::Setup& setup) {
        mount_ = Mount<D>(*this);
        law_ = NoiseLaw<M>(setup, *this, this->derived().measurement_space());
    }
    pelorus::Space cartesian_space() const {
        return Rates ? pelorus::kinematic_space(D, {0.0, 0.0}) : pelorus::position_space(D);
    }
    pelorus::Space inverse_space() const { return pelorus::position_space(D); }
    pelorus::Space waveform_space() const { return law_.waveform_space(); }
    std::uint32_t instance_flags() const noexcept { return law_.held(Derived::flags); }
    std::uint64_t scratch_bytes() const noexcept { return law_.scratch_bytes(); }

    Measurement measure(const Cartesian& x, const Look& look) const {
        const Measurement z = this->derived().seen(along_axes(x, pose(look)));
        return Base::residual(z, -bias(look));  // z + bias, angles wrapped
    }
    Jacobian jacobian(const Cartesian& x, const Look& look) const {
        const Pose<D> at = pose(look);
        const Jacobian along = this->derived().slope(along_axes(x, at));
        Jacobian out;
        for (int block = 0; block < (Rates ? 2 : 1); ++block) {
            const Matrix<M, D> part = along.template block<M, D>(0, block * D);
            Matrix<M, D> turned;
            pelorus::small::multiply_transposed(part, at.rotation, turned);
            out.template block<M, D>(0, block * D) = turned;
        }
        return out;
    }
    Noise noise(const Query& query, const Look& look) const {
        double range = 0.0;
        if (law_.depends_on_range()) range = (query.cartesian.template head<D>() - pose(look).position).stableNorm();
        return law_(range, query.snr, query.waveform, look);
    }
    Inverse invert(const Measurement& measurement, const Noise& errors, const Look& look) const {
        const Pose<D> at = pose(look);
        const Measurement z = measurement - bias(look);
        const Inverse along = this->derived().converted(z, errors);
        Inverse out;
        pelorus::small::multiply(at.rotation, along.mean, out.mean);
        out.mean += at.position;
        pelorus::small::symmetric_product(at.rotation, along.covariance, out.covariance);
        return out;
    }

protected:
    Pose<D> pose(const Look& look) const {
        return mount_.pose(this->input(look, position_input), this->input(look, attitude_input),
                           this->input(look, error_input), Rates ? this->input(look, velocity_input) : nullptr);
    }
    Measurement bias(const Look& look) const {
        return Eigen::Map<const Measurement>(this->input(look, bias_input) + Derived::bias_offset);
    }

private:
    enum Input : std::size_t { bias_input, position_input, attitude_input, velocity_input };
    static constexpr std::size_t error_input = Rates ? velocity_input + 1 : velocity_input;

    static Cartesian along_axes(const Cartesian& x, const Pose<D>& at) {
        Cartesian out;
        const Vector<D> from_sensor = x.template head<D>() - at.position;
        out.template head<D>() = at.rotation.transpose() * from_sensor;
        if constexpr (Rates) {
            const Vector<D> relative = x.template tail<D>() - at.velocity;
            out.template tail<D>() = at.rotation.transpose() * relative;
        }
        return out;
    }

    Mount<D> mount_;
    NoiseLaw<M> law_;
};

}  // namespace sensing
