// A motion whose state is not Cartesian, with an angle, a record of its own and a noise that wants all that a filter knows.
#pragma once

#include <cmath>

#include <pelorus/motion.hpp>
#include <pelorus/sensor.hpp>

namespace test_support {

/// A point that stands still, in the plane: state (ln range, azimuth, drift); drift, which nothing Cartesian tells of, adds to
/// the azimuth. The noise grows with the number of steps made so far, which the record holds, and with the extent.
struct LogPolar : pelorus::Motion<LogPolar, 3, 2> {
    static constexpr bool cartesian = false;
    static constexpr int record_size = 2;
    static constexpr std::uint32_t flags = PLR_MOTION_USES_EXTENT;
    using Record = pelorus::Vector<2>;
    using pelorus::Motion<LogPolar, 3, 2>::Cartesian;

    static void describe(pelorus::Describe<LogPolar>& plugin) { plugin.title("test"); }
    pelorus::Space space() const {
        return pelorus::Space({{"log_range", "1", 0.0, 1.0, false},
                               {"azimuth", "rad", 0.0, 1.0, true},
                               {"drift", "rad/s", 0.0, 0.3, false}});
    }
    pelorus::Space cartesian_space() const { return pelorus::position_space(2); }
    State propagate(const State& x, const pelorus::Step& step) const {
        return {x(0), pelorus::wrap_angle(x(1) + x(2) * step.dt), x(2)};
    }
    Transition jacobian(const State&, const pelorus::Step& step) const {
        Transition f = Transition::Identity();
        f(1, 2) = step.dt;
        return f;
    }
    Transition noise(const Posterior& posterior, const pelorus::Step& step) const {
        if (!(std::fabs(posterior.predicted(2) - posterior.mean(2)) < 1e-14))
            throw pelorus::NumericError("predicted does not belong to mean");
        return (step.record[0] + posterior.covariance(0, 0)) * posterior.extent[0] * step.dt * Transition::Identity();
    }
    Record init_record(const State& x, const Transition&) const { return {0.0, x(0)}; }
    Record advance_record(const State&, const Transition& p, const pelorus::Step& step) const {
        return {step.record[0] + 1.0, p(1, 1)};
    }
    Cartesian to_cartesian(const State& x) const { return std::exp(x(0)) * Cartesian(std::cos(x(1)), std::sin(x(1))); }
    pelorus::Matrix<2, 3> to_cartesian_jacobian(const State& x) const {
        const Cartesian p = to_cartesian(x);
        pelorus::Matrix<2, 3> j;
        j << p(0), -p(1), 0.0, p(1), p(0), 0.0;
        return j;
    }
    State from_cartesian(const Cartesian& p) const { return {std::log(p.norm()), std::atan2(p(1), p(0)), 0.0}; }
    pelorus::Matrix<3, 2> from_cartesian_jacobian(const Cartesian& p) const {
        const double square = p.squaredNorm();
        pelorus::Matrix<3, 2> j;
        j << p(0) / square, p(1) / square, -p(1) / square, p(0) / square, 0.0, 0.0;
        return j;
    }
};

inline const plr_plugin& log_polar() {
    return *pelorus::detail::plugin<LogPolar>("motion.test_log_polar", "motion.test_log_polar");
}

}  // namespace test_support
