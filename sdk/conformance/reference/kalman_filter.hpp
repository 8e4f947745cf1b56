/// The Kalman filter as textbooks have it (Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and
/// Navigation, 2001, 5.2 and 10.3; Joseph's form of the update, 5.2.3-18), written to be checked by reading, not for speed: the
/// parts are called item by item. The motion's state must be Cartesian and keep no record.
///
/// The record of a track: [mean (n), covariance (n x n)].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <pelorus/pelorus.hpp>

namespace pelorus::conformance {

/// A class derived from it adds `describe`; see describe_slots.
template <class Derived> struct KalmanFilter : pelorus::Estimator<Derived> {
    static constexpr int max_state = 12, max_measurement = 6;
    template <int Rows, int Cols> using Bounded = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Rows, Cols>;
    using pelorus::Estimator<Derived>::info;
    using StateVector = Bounded<max_state, 1>;
    using StateMatrix = Bounded<max_state, max_state>;
    using MeasurementVector = Bounded<max_measurement, 1>;
    using MeasurementMatrix = Bounded<max_measurement, max_measurement>;
    using Cross = Bounded<max_state, max_measurement>;

    struct Moments {
        StateVector mean;
        StateMatrix covariance;
    };

    static void describe_slots(pelorus::Describe<Derived>& plugin) {
        plugin.slot("motion", "motion", 1, 1, "how the state evolves");
        plugin.slot("sensors", "sensor", 1, -1, "what measures it");
    }

    void setup(const pelorus::Setup& setup) {
        motion = setup.part<pelorus::MotionPart>("motion");
        sensors = setup.parts<pelorus::SensorPart>("sensors");
        space = pelorus::Space(*motion.info().state);
        n = space.size();
        if (n > max_state) throw pelorus::PartError("motion", "has more than 12 state components");
        if (motion.info().record_size != 0)
            throw pelorus::PartError("motion", "keeps a record, which is not supported");
        if (!space.same(pelorus::Space(*motion.info().cartesian)))
            throw pelorus::PartError("motion", "has a state that is not Cartesian, which is not supported");
        for (const pelorus::SensorPart& sensor : sensors) add(sensor);
        info.flags = PLR_ESTIMATOR_ASSIGNABLE;
        if ((motion.info().flags & PLR_MOTION_BACKWARD) != 0) info.flags |= PLR_ESTIMATOR_BACKWARD;
        if ((motion.info().flags & PLR_MOTION_USES_EXTENT) != 0) info.flags |= PLR_ESTIMATOR_USES_EXTENT;
        info.state = info.cartesian = motion.info().state;
        info.record_size = n + n * n;
        info.record_version = 1;
        info.sensors = sensor_parts.data();
        info.sensor_count = static_cast<std::uint32_t>(sensor_parts.size());
        info.scratch_bytes = motion.info().scratch_bytes;
        for (const pelorus::SensorPart& sensor : sensors)
            info.scratch_bytes = std::max(info.scratch_bytes, sensor.info().scratch_bytes);
    }

    plr_status init(const plr_call& call, const plr_estimator_init& args) const {
        const std::int64_t count = args.record.count, known = args.known;
        for (std::int64_t k = 0; k < known; ++k)
            if (args.components[k] < (k == 0 ? 0 : args.components[k - 1] + 1) || args.components[k] >= n)
                throw pelorus::ArgumentError("components: are not ascending indices below " + std::to_string(n));
        pelorus::expect(args.mean, known, 1, count, "mean");
        pelorus::expect(args.covariance, known, known, count, "covariance");
        expect_record(args.record, "record");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            Moments x{StateVector(n, 1), StateMatrix::Zero(n, n)};
            for (int k = 0; k < n; ++k) {  // what is not known
                x.mean(k) = space[k].prior_mean;
                x.covariance(k, k) = space[k].prior_deviation * space[k].prior_deviation;
            }
            const auto mean = pelorus::item(args.mean, i), covariance = pelorus::item(args.covariance, i);
            for (std::int64_t c = 0; c < known; ++c) {
                x.mean(args.components[c]) = mean(c, 0);
                for (std::int64_t r = 0; r < known; ++r)
                    x.covariance(args.components[r], args.components[c]) = covariance(r, c);
            }
            write(args.record, i, x);
        });
    }

    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const {
        pelorus::expect(args.dt, 1, 1, args.out.count, "dt");
        expect_records(args.record, args.out);
        return pelorus::for_items(call, args.out.count, [&](std::int64_t i) {
            Moments x = read(args.record, i);
            const double dt = args.dt.data[i * args.dt.item_stride];
            if (dt < 0 && (info.flags & PLR_ESTIMATOR_BACKWARD) == 0)
                throw pelorus::UnsupportedError("cannot move backward in time (dt < 0)");
            if (dt != 0) move(x, dt, args, i, pelorus::slice(call, i));
            write(args.out, i, x);
        });
    }

    plr_status project(const plr_call& call, const plr_estimator_project& args) const {
        const std::int64_t count = args.measurement.count, m = measured_by(args.sensor);
        expect_record(args.record, count, "record");
        pelorus::expect(args.measurement, m, 1, count, "measurement");
        pelorus::expect(args.covariance, m, m, count, "covariance");
        expect_optional(args.cross, n, m, count, "cross");
        expect_optional(args.cartesian_cross, n, m, count, "cartesian_cross");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Moments x = read(args.record, i);
            const Look look = look_at(x.mean, args.sensor, pelorus::slice(call, i));
            const Cross cross = x.covariance * look.h.transpose();
            MeasurementMatrix projected = look.h * cross;
            symmetrise(projected);
            put(args.measurement, i, look.measurement);
            put(args.covariance, i, projected);
            if (args.cross.data != nullptr) put(args.cross, i, cross);
            if (args.cartesian_cross.data != nullptr) put(args.cartesian_cross, i, cross);
        });
    }

    plr_status update(const plr_call& call, const plr_estimator_update& args) const {
        const std::int64_t count = args.out.count, m = measured_by(args.sensor);
        expect_records(args.record, args.out);
        pelorus::expect(args.measurement, m, 1, count, "measurement");
        pelorus::expect(args.noise, m, m, count, "noise");
        expect_optional(args.log_likelihood, 1, 1, count, "log_likelihood");
        expect_optional(args.innovation, m, 1, count, "innovation");
        expect_optional(args.innovation_covariance, m, m, count, "innovation_covariance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const plr_call one = pelorus::slice(call, i);
            Moments x = read(args.record, i);
            const Look look = look_at(x.mean, args.sensor, one);
            MeasurementVector innovation(m, 1);
            auto difference = pelorus::arguments<plr_sensor_residual>();
            difference.measurement = pelorus::slice(args.measurement, i, 1);
            difference.reference = pelorus::const_view(look.measurement);
            difference.out = pelorus::view(innovation);
            require_item(sensors[index(args.sensor)].call(&plr_sensor::residual, one, difference), one);

            const MeasurementMatrix r = pelorus::item(args.noise, i);
            MeasurementMatrix s = look.h * x.covariance * look.h.transpose() + r;
            symmetrise(s);
            const Eigen::LLT<MeasurementMatrix> root(s);
            if (root.info() != Eigen::Success)
                throw pelorus::NumericError("the innovation covariance is not positive definite");
            const Cross gain = root.solve(look.h * x.covariance).transpose();
            x.mean += gain * innovation;
            const StateMatrix rest = StateMatrix::Identity(n, n) - gain * look.h;
            x.covariance = (rest * x.covariance * rest.transpose() + gain * r * gain.transpose()).eval();
            write(args.out, i, x);
            if (args.innovation.data != nullptr) put(args.innovation, i, innovation);
            if (args.innovation_covariance.data != nullptr) put(args.innovation_covariance, i, s);
            if (args.log_likelihood.data != nullptr)
                put(args.log_likelihood, i, Bounded<1, 1>::Constant(1, 1, log_normal(root, innovation)));
        });
    }

    /// The state is Cartesian: both are the same.
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const {
        return static_cast<const Derived*>(this)->moments(call, args);
    }
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const {
        const std::int64_t count = args.mean.count;
        expect_record(args.record, count, "record");
        pelorus::expect(args.mean, n, 1, count, "mean");
        expect_optional(args.covariance, n, n, count, "covariance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const Moments x = read(args.record, i);
            put(args.mean, i, x.mean);
            if (args.covariance.data != nullptr) put(args.covariance, i, x.covariance);
        });
    }
    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const {
        const std::int64_t count = args.out.count;
        expect_records(args.record, args.out);
        pelorus::expect(args.mean, n, 1, count, "mean");
        pelorus::expect(args.covariance, n, n, count, "covariance");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            write(args.out, i, {pelorus::item(args.mean, i), pelorus::item(args.covariance, i)});
        });
    }

    /// Moments of a weighted mixture.
    plr_status mix(const plr_call& call, const plr_estimator_mix_args& args) const {
        const std::int64_t count = args.out.count, hypotheses = args.weights.rows;
        pelorus::expect(args.weights, hypotheses, 1, count, "weights");
        pelorus::expect(args.records, info.record_size, hypotheses, count, "records");
        expect_record(args.out, "out");
        return pelorus::for_items(call, count, [&](std::int64_t i) {
            const auto weights = pelorus::item(args.weights, i);
            Moments mixed{StateVector::Zero(n, 1), StateMatrix::Zero(n, n)};
            for (std::int64_t k = 0; k < hypotheses; ++k)
                mixed.mean += weights(k, 0) * read(column(args.records, k), i).mean;
            for (std::int64_t k = 0; k < hypotheses; ++k) {
                const Moments x = read(column(args.records, k), i);
                const StateVector apart = x.mean - mixed.mean;
                mixed.covariance += weights(k, 0) * (x.covariance + apart * apart.transpose());
            }
            write(args.out, i, mixed);
        });
    }
    const void* extension(const char* id) const noexcept {
        static constexpr plr_estimator_mix mixing{
            sizeof(plr_estimator_mix), 0, &pelorus::detail::forward<Derived, plr_estimator_mix_args, &Derived::mix>};
        return std::strcmp(id, PLR_ESTIMATOR_MIX) == 0 ? &mixing : nullptr;
    }

    // ------------------------------------------------------------------------------------------------------ records
    Moments read(const plr_const_view& records, std::int64_t i) const {
        const double* record = records.data + i * records.item_stride;
        return {Eigen::Map<const StateVector>(record, n, 1), Eigen::Map<const StateMatrix>(record + n, n, n)};
    }
    void write(const plr_view& records, std::int64_t i, Moments x) const {
        if (!x.mean.allFinite() || !x.covariance.allFinite()) throw pelorus::NumericError("a result is not finite");
        symmetrise(x.covariance);
        double* record = records.data + i * records.item_stride;
        Eigen::Map<StateVector>(record, n, 1) = x.mean;
        Eigen::Map<StateMatrix>(record + n, n, n) = x.covariance;
    }
    template <class Matrix> static void put(const plr_view& to, std::int64_t i, const Matrix& from) {
        if (!from.allFinite()) throw pelorus::NumericError("a result is not finite");
        Eigen::Map<Eigen::MatrixXd>(to.data + i * to.item_stride, to.rows, to.cols) = from;
    }
    template <class Square> static void symmetrise(Square& p) {
        for (Eigen::Index c = 0; c < p.cols(); ++c)
            for (Eigen::Index r = 0; r < c; ++r) p(r, c) = p(c, r) = (p(r, c) + p(c, r)) / 2;
    }

    void expect_record(const plr_view& record, const char* what) const {
        pelorus::expect(record, info.record_size, 1, record.count, what);
    }
    void expect_record(const plr_const_view& record, std::int64_t count, const char* what) const {
        pelorus::expect(record, info.record_size, 1, count, what);
    }
    void expect_records(const plr_const_view& record, const plr_view& out) const {
        expect_record(record, out.count, "record");
        expect_record(out, "out");
    }
    static void expect_optional(const plr_view& view, std::int64_t rows, std::int64_t cols, std::int64_t count,
                                const char* what) {
        if (view.data != nullptr) pelorus::expect(view, rows, cols, count, what);
    }

    pelorus::MotionPart motion;
    std::vector<pelorus::SensorPart> sensors;
    std::vector<plr_part> sensor_parts;   // the same, as holders want to see them
    std::vector<std::vector<int>> looks;  // [sensors] which state component each of its Cartesian ones is
    pelorus::Space space;
    int n = 0;

private:
    struct Look {
        MeasurementVector measurement;          // predicted
        Bounded<max_measurement, max_state> h;  // its derivative by the state
    };

    void add(const pelorus::SensorPart& sensor) {
        if (sensor.info().measurement->size > max_measurement)
            throw pelorus::PartError("sensors", sensor.name() + " measures more than 6 components");
        looks.emplace_back();
        const pelorus::Space wanted(*sensor.info().cartesian);
        for (const pelorus::Component& component : wanted.components()) {
            const int at = space.index(component.name);
            if (at < 0)
                throw pelorus::PartError("sensors", sensor.name() + " looks at " + component.name +
                                                        ", which the motion's state does not have");
            looks.back().push_back(at);
        }
        sensor_parts.push_back(sensor.raw());
    }
    std::size_t index(std::int32_t sensor) const {
        if (sensor < 0 || static_cast<std::size_t>(sensor) >= sensors.size())
            throw pelorus::ArgumentError("sensor: is " + std::to_string(sensor) + ", expected 0 to " +
                                         std::to_string(sensors.size() - 1));
        return static_cast<std::size_t>(sensor);
    }
    std::int64_t measured_by(std::int32_t sensor) const { return sensors[index(sensor)].info().measurement->size; }

    /// x = f(x), P = F P F' + Q.
    void move(Moments& x, double dt, const plr_estimator_predict& args, std::int64_t i, const plr_call& one) const {
        StateVector moved(n, 1);
        StateMatrix f(n, n), q(n, n);
        auto step = pelorus::arguments<plr_motion_propagate>();
        step.dt = pelorus::const_view(&dt, 1, 1, 1);
        step.state = pelorus::const_view(x.mean);
        step.out = pelorus::view(moved);
        require_item(motion.call(&plr_motion::propagate, one, step), one);
        auto derivative = pelorus::arguments<plr_motion_jacobian>();
        derivative.dt = step.dt;
        derivative.state = step.state;
        derivative.out = pelorus::view(f);
        require_item(motion.call(&plr_motion::jacobian, one, derivative), one);
        auto noise = pelorus::arguments<plr_motion_noise>();
        noise.dt = step.dt;
        noise.state = step.state;
        noise.covariance = pelorus::const_view(x.covariance);
        noise.predicted = pelorus::const_view(moved);
        noise.extent = pelorus::slice(args.extent, i, 1);
        noise.out = pelorus::view(q);
        require_item(motion.call(&plr_motion::noise, one, noise), one);
        x.mean = moved;
        x.covariance = (f * x.covariance * f.transpose() + q).eval();
    }

    Look look_at(const StateVector& mean, std::int32_t sensor, const plr_call& one) const {
        const pelorus::SensorPart& part = sensors[index(sensor)];
        const std::vector<int>& components = looks[index(sensor)];
        const auto c = static_cast<Eigen::Index>(components.size());
        const auto m = static_cast<Eigen::Index>(part.info().measurement->size);
        StateVector cartesian(c, 1);
        for (Eigen::Index k = 0; k < c; ++k) cartesian(k) = mean(components[static_cast<std::size_t>(k)]);
        Look look{MeasurementVector(m, 1), Bounded<max_measurement, max_state>::Zero(m, n)};
        Bounded<max_measurement, max_state> derivative(m, c);
        auto measure = pelorus::arguments<plr_sensor_measure>();
        measure.cartesian = pelorus::const_view(cartesian);
        measure.out = pelorus::view(look.measurement);
        require_item(part.call(&plr_sensor::measure, one, measure), one);
        auto jacobian = pelorus::arguments<plr_sensor_jacobian>();
        jacobian.cartesian = measure.cartesian;
        jacobian.out = pelorus::view(derivative);
        require_item(part.call(&plr_sensor::jacobian, one, jacobian), one);
        for (Eigen::Index k = 0; k < c; ++k) look.h.col(components[static_cast<std::size_t>(k)]) = derivative.col(k);
        return look;
    }

    /// Throws unless a part's call for one item went well. The part has told why already.
    static void require_item(plr_status status, const plr_call& one) {
        if (status == PLR_ITEMS_FAILED && one.item_status != nullptr) throw pelorus::PartFailed(one.item_status[0]);
        pelorus::require(status);
    }
    static double log_normal(const Eigen::LLT<MeasurementMatrix>& root, const MeasurementVector& innovation) {
        const double log_two_pi = std::log(2 * 3.14159265358979323846);
        const MeasurementVector white = root.matrixL().solve(innovation);
        return -0.5 * (white.squaredNorm() + static_cast<double>(innovation.rows()) * log_two_pi) -
               root.matrixLLT().diagonal().array().log().sum();
    }
    static plr_const_view column(plr_const_view records, std::int64_t k) noexcept {
        records.data += k * records.col_stride;
        return records;
    }
};

}  // namespace pelorus::conformance
