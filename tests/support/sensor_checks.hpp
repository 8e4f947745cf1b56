// A sensor plugin's answers for one item, and what holds for every sensor.
#pragma once

#include "plugin_instance.hpp"

#include <random>

#include <catch2/catch.hpp>

namespace test_support {

class SensorUnderTest {
public:
    explicit SensorUnderTest(const Instance& instance)
        : part_(instance.as<pelorus::SensorPart>()),
          m_(part_.info().measurement->size),
          c_(part_.info().cartesian->size) {}

    const pelorus::SensorPart& part() const noexcept { return part_; }
    std::uint32_t flags() const noexcept { return part_.info().flags; }
    std::string component(std::size_t i) const { return part_.info().measurement->components[i].name; }

    /// Values of the sensor's inputs for the calls to come; nullptr: the defaults.
    void inputs(const double* values) { inputs_ = values; }

    Eigen::VectorXd measure(const Eigen::VectorXd& x) const {
        Eigen::VectorXd out(m_);
        auto args = pelorus::arguments<plr_sensor_measure>();
        args.cartesian = pelorus::const_view(x.data(), c_, 1, 1);
        args.out = pelorus::view(out.data(), m_, 1, 1);
        run(&plr_sensor::measure, args);
        return out;
    }
    Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const {
        Eigen::MatrixXd out(m_, c_);
        auto args = pelorus::arguments<plr_sensor_jacobian>();
        args.cartesian = pelorus::const_view(x.data(), c_, 1, 1);
        args.out = pelorus::view(out.data(), m_, c_, 1);
        run(&plr_sensor::jacobian, args);
        return out;
    }
    Eigen::MatrixXd noise() const {
        Eigen::MatrixXd out(m_, m_);
        auto args = pelorus::arguments<plr_sensor_noise>();
        args.out = pelorus::view(out.data(), m_, m_, 1);
        run(&plr_sensor::noise, args);
        return out;
    }
    /// Noise of an object at x; `snr` a power ratio, `waveform` the parameters in force, or nullptr.
    Eigen::MatrixXd noise_at(const Eigen::VectorXd& x, const double* snr = nullptr,
                             const double* waveform = nullptr) const {
        Eigen::MatrixXd out(m_, m_);
        auto args = pelorus::arguments<plr_sensor_noise>();
        args.cartesian = pelorus::const_view(x.data(), c_, 1, 1);
        if (snr != nullptr) args.snr = pelorus::const_view(snr, 1, 1, 1);
        if (waveform != nullptr) args.waveform = pelorus::const_view(waveform, part_.info().waveform->size, 1, 1);
        args.out = pelorus::view(out.data(), m_, m_, 1);
        run(&plr_sensor::noise, args);
        return out;
    }
    Eigen::VectorXd residual(const Eigen::VectorXd& measurement, const Eigen::VectorXd& from) const {
        Eigen::VectorXd out(m_);
        auto args = pelorus::arguments<plr_sensor_residual>();
        args.measurement = pelorus::const_view(measurement.data(), m_, 1, 1);
        args.reference = pelorus::const_view(from.data(), m_, 1, 1);
        args.out = pelorus::view(out.data(), m_, 1, 1);
        run(&plr_sensor::residual, args);
        return out;
    }
    /// Mean and, in the columns after it, covariance.
    std::pair<Eigen::VectorXd, Eigen::MatrixXd> invert(const Eigen::VectorXd& measurement,
                                                       const Eigen::MatrixXd& noise) const {
        const std::int64_t size = part_.info().inverse->size;
        Eigen::VectorXd mean(size);
        Eigen::MatrixXd covariance(size, size);
        auto args = pelorus::arguments<plr_sensor_invert>();
        args.measurement = pelorus::const_view(measurement.data(), m_, 1, 1);
        args.noise = pelorus::const_view(noise.data(), m_, m_, 1);
        args.mean = pelorus::view(mean.data(), size, 1, 1);
        args.covariance = pelorus::view(covariance.data(), size, size, 1);
        run(&plr_sensor::invert, args);
        return {mean, covariance};
    }

    /// Central differences of measure, wrapped by residual.
    Eigen::MatrixXd differences(const Eigen::VectorXd& x, double step) const {
        Eigen::MatrixXd out(m_, c_);
        for (std::int64_t k = 0; k < c_; ++k) {
            Eigen::VectorXd up = x, down = x;
            up(k) += step;
            down(k) -= step;
            out.col(k) = residual(measure(up), measure(down)) / (up(k) - down(k));
        }
        return out;
    }

    /// The Jacobian is the derivative of measure at x: rows agree with central differences to `relative` of their largest.
    void check_jacobian(const Eigen::VectorXd& x, double step, double relative = 1e-6) const {
        const Eigen::MatrixXd exact = jacobian(x), approximate = differences(x, step);
        for (std::int64_t r = 0; r < m_; ++r) {
            INFO("row " << r << ": " << exact.row(r) << " and by differences " << approximate.row(r));
            CHECK((exact.row(r) - approximate.row(r)).cwiseAbs().maxCoeff() <
                  relative * exact.row(r).cwiseAbs().maxCoeff());
        }
    }
    /// Averaged over normal errors of these deviations, invert gives the place itself, with the covariance that it tells at the
    /// exact measurement: within four deviations of the mean, and within 3 % of the largest element.
    void check_conversion(const Eigen::VectorXd& x, const Eigen::VectorXd& deviations) const {
        const Eigen::MatrixXd noise = deviations.cwiseAbs2().asDiagonal();
        const Eigen::VectorXd exact = measure(x);
        const Eigen::MatrixXd expected = invert(exact, noise).second;
        const Eigen::Index size = expected.rows();
        std::mt19937_64 engine(4);
        std::normal_distribution<double> normal;
        constexpr int draws = 40000;
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(size);
        Eigen::MatrixXd square = Eigen::MatrixXd::Zero(size, size);
        for (int k = 0; k < draws; ++k) {
            Eigen::VectorXd z = exact;
            for (Eigen::Index r = 0; r < z.size(); ++r) z(r) += deviations(r) * normal(engine);
            const Eigen::VectorXd error = invert(z, noise).first - x.head(size);
            sum += error;
            square += error * error.transpose();
        }
        for (Eigen::Index r = 0; r < size; ++r)
            CHECK(std::fabs(sum(r) / draws) < 4.0 * std::sqrt(expected(r, r) / draws));
        CHECK((square / draws - expected).cwiseAbs().maxCoeff() < 0.03 * expected.cwiseAbs().maxCoeff());
    }

private:
    template <class Function, class Args> void run(Function function, const Args& args) const {
        Call call;
        if (inputs_ != nullptr) call.inputs(inputs_);
        if (part_.call(function, call, args) != PLR_OK) throw std::runtime_error(call.message());
    }

    pelorus::SensorPart part_;
    std::int64_t m_, c_;
    const double* inputs_ = nullptr;
};

}  // namespace test_support
