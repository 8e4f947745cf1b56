// A Kalman filter over one motion and its sensors, with what an estimator may do wrong. Its record goes on behind the moments:
// [.., whether it was updated since the last prediction, number of predictions].
#include <cmath>
#include <limits>

#include "../../../sdk/conformance/reference/kalman_filter.hpp"
#include "defect.h"

namespace {

struct Saboteur : pelorus::conformance::KalmanFilter<Saboteur> {
    using Base = pelorus::conformance::KalmanFilter<Saboteur>;
    static constexpr std::int64_t further = 2;
    static constexpr std::int64_t steady = 30;  // predictions

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("A filter with a defect")
            .purpose("The Kalman filter, for the proof that the conformance suites can fail.")
            .equation(
                "predict: x = F x, P = F P F' + Q. update: K = P H' S^-1, x = x + K e, P = (I - K H) P (I - K H)' + K "
                "R K'")
            .source(
                "R. E. Kalman, A new approach to linear filtering and prediction problems, Journal of Basic "
                "Engineering 82, 35-45, 1960");
        describe_slots(plugin);
    }

    void setup(const pelorus::Setup& setup) {
        Base::setup(setup);
        info.record_size += further;
        if (DEFECT("estimator-spaces-well-formed")) {  // velocities first
            std::vector<pelorus::Component> components = space.components();
            std::rotate(components.begin(), components.begin() + n / 2, components.end());
            told_ = pelorus::Space(components);
            info.cartesian = told_.c();
        }
        if (NEAR_MISS("estimator-spaces-well-formed")) know_velocity_to(1e-3);
        if (DEFECT("estimator-sensors-as-in-slot")) std::reverse(sensor_parts.begin(), sensor_parts.end());
        if (NEAR_MISS("estimator-sensors-as-in-slot")) {
            names_.reserve(sensor_parts.size());
            for (plr_part& part : sensor_parts) part.name = names_.emplace_back(part.name).c_str();
        }
        if (DEFECT("estimator-assignable-as-declared") || NEAR_MISS("estimator-assignable-as-declared"))
            info.flags &= ~std::uint32_t{PLR_ESTIMATOR_ASSIGNABLE};
    }
    static const plr_estimator& table() noexcept {
        static const plr_estimator own = [] {
            plr_estimator made = Base::table();
            if (NEAR_MISS("estimator-assignable-as-declared")) made.assign = nullptr;
            return made;
        }();
        return own;
    }

    plr_status init(const plr_call& call, const plr_estimator_init& args) const {
        const plr_status status = Base::init(call, args);
        if (status < 0) return status;
        double factor = 0;
        if (NEAR_MISS("estimator-unknown-starts-from-prior")) factor = 1 + 1e-12;
        for (std::int64_t i = 0; i < args.record.count; ++i) {
            double* const record = args.record.data + i * args.record.item_stride;
            record[n + n * n] = record[n + n * n + 1] = 0;
            for (int k = 0; k < n; ++k) {
                if (std::binary_search(args.components, args.components + args.known, k)) continue;
                double& variance = record[n + k * n + k];
                if (DEFECT("estimator-unknown-starts-from-prior")) variance = std::sqrt(variance);
                if (factor > 0) variance *= factor;
            }
        }
        return status;
    }

    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const {
        pelorus::expect(args.dt, 1, 1, args.out.count, "dt");
        return one_by_one(call, args.out.count, [&](const plr_call& one, std::int64_t i) {
            double dt = args.dt.data[i * args.dt.item_stride];
            if (NEAR_MISS("estimator-backward-as-declared") && dt < 0)
                return pelorus::for_items(
                    one, 1, [](std::int64_t) { throw pelorus::UnsupportedError("what is past is past"); });
            if (DEFECT("estimator-backward-as-declared")) dt = std::fabs(dt);
            if (NEAR_MISS("estimator-zero-step-copies") && std::fabs(dt) < 1e-9) dt = 0;
            plr_estimator_predict step = args;
            step.dt = pelorus::const_view(&dt, 1, 1, 1);
            step.extent = pelorus::slice(args.extent, i, 1);
            step.record = pelorus::slice(args.record, i, 1);
            step.out = pelorus::slice(args.out, i, 1);
            const double updated = step.record.data[n + n * n], predictions = step.record.data[n + n * n + 1];
            const plr_status status = Base::predict(one, step);
            if (status != PLR_OK) return status;
            double* const out = step.out.data;
            Eigen::Map<Eigen::MatrixXd> p(out + n, n, n);
            out[n + n * n] = dt == 0 ? updated : 0;
            out[n + n * n + 1] = dt == 0 ? predictions : predictions + 1;
            if (dt == 0 && DEFECT("estimator-zero-step-copies")) p *= 1 + 1e-12;
            if (dt == 0) return status;
            const bool is_late = predictions >= steady;
            if (DEFECT("estimator-predicts-as-its-motion") || (is_late && DEFECT("estimator-errors-match-covariance")))
                without_noise(one, dt, out);
            if (DEFECT("estimator-predicts-as-its-motion.unsure")) p *= 1.9;
            if (NEAR_MISS("estimator-predicts-as-its-motion") ||
                (is_late && NEAR_MISS("estimator-errors-match-covariance")))
                p *= 1.02;
            return status;
        });
    }

    plr_status project(const plr_call& call, const plr_estimator_project& args) const {
        plr_estimator_project wanted = args;
        if (DEFECT("estimator-refuses-unknown-sensor")) wanted.sensor = nearest(args.sensor);
        if (NEAR_MISS("estimator-refuses-unknown-sensor") && wanted.sensor != nearest(args.sensor))
            return all_failed(call, args.measurement.count);
        if (DEFECT("estimator-optional-outputs") && args.cross.data == nullptr)
            wanted.cartesian_cross = pelorus::absent_output();
        if (NEAR_MISS("estimator-optional-outputs") && args.cross.data == nullptr) {
            wanted.cross = args.cartesian_cross;
            wanted.cartesian_cross = pelorus::absent_output();
        }
        const plr_status status = Base::project(call, wanted);
        if (status < 0) return status;
        for (std::int64_t i = 0; i < args.measurement.count; ++i) {
            const plr_view& covariance = args.covariance;
            Eigen::Map<Eigen::MatrixXd> s(covariance.data + i * covariance.item_stride, covariance.rows,
                                          covariance.rows);
            if (DEFECT("estimator-projects-without-noise")) s.diagonal().array() += 100.0;
            if (NEAR_MISS("estimator-projects-without-noise")) s *= 1 + 1e-10;
            if (args.cross.data == nullptr) continue;
            Eigen::Map<Eigen::MatrixXd> cross(args.cross.data + i * args.cross.item_stride, args.cross.rows,
                                              args.cross.cols);
            if (DEFECT("estimator-cross-covariance")) cross.bottomRows(n / 2).setZero();
            if (NEAR_MISS("estimator-cross-covariance")) cross *= 1 + 1e-10;
        }
        return status;
    }

    plr_status update(const plr_call& call, const plr_estimator_update& args) const {
        const std::int32_t sensor = DEFECT("estimator-refuses-unknown-sensor") ? nearest(args.sensor) : args.sensor;
        if (NEAR_MISS("estimator-refuses-unknown-sensor") && sensor != nearest(args.sensor))
            return all_failed(call, args.out.count);
        const auto m = args.measurement.rows;
        expect_records(args.record, args.out);
        expect_optional(args.log_likelihood, 1, 1, args.out.count, "log_likelihood");
        expect_optional(args.innovation, m, 1, args.out.count, "innovation");
        expect_optional(args.innovation_covariance, m, m, args.out.count, "innovation_covariance");
        return one_by_one(call, args.out.count, [&](const plr_call& one, std::int64_t i) {
            if (m > max_measurement) return plr_status{PLR_E_ARGUMENT};
            double log_likelihood = 0;
            MeasurementVector innovation(m, 1);
            MeasurementMatrix s(m, m);
            plr_estimator_update step = args;
            step.sensor = sensor;
            step.record = pelorus::slice(args.record, i, 1);
            step.measurement = pelorus::slice(args.measurement, i, 1);
            step.noise = pelorus::slice(args.noise, i, 1);
            step.out = pelorus::slice(args.out, i, 1);
            step.log_likelihood = pelorus::view(&log_likelihood, 1, 1, 1);
            step.innovation = pelorus::view(innovation);
            step.innovation_covariance = pelorus::view(s);
            if (DEFECT("estimator-in-place-same-bits") ||
                (NEAR_MISS("estimator-in-place-same-bits") && args.out.data != args.record.data))
                std::fill_n(step.out.data, info.record_size, 0.0);
            const Moments before = read(step.record, 0);
            const double updated = step.record.data[n + n * n], predictions = step.record.data[n + n * n + 1];
            const plr_status status = Base::update(one, step);
            if (status != PLR_OK) return status;
            Moments after = read(pelorus::as_const(step.out), 0);
            distort(before, s, updated, log_likelihood, after);
            if (NEAR_MISS("estimator-far-measurement-is-finite-or-flagged") && log_likelihood < -1e6)
                return failed(one, "the measurement is not of this track");
            if (DEFECT("estimator-likelihood-integrates-to-one"))
                log_likelihood += 0.5 * static_cast<double>(m) * std::log(2 * 3.14159265358979323846);
            if (NEAR_MISS("estimator-likelihood-integrates-to-one")) log_likelihood += 0.01;
            Eigen::Map<StateVector>(step.out.data, n, 1) = after.mean;
            Eigen::Map<StateMatrix>(step.out.data + n, n, n) = after.covariance;
            step.out.data[n + n * n] = 1;
            step.out.data[n + n * n + 1] = predictions;
            if (args.log_likelihood.data != nullptr)
                put(args.log_likelihood, i, Bounded<1, 1>::Constant(1, 1, log_likelihood));
            if (args.innovation.data != nullptr) put(args.innovation, i, innovation);
            if (args.innovation_covariance.data != nullptr) put(args.innovation_covariance, i, s);
            return status;
        });
    }

    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const {
        const plr_status status = moments(call, args);
        if (status < 0 || args.covariance.data == nullptr) return status;
        for (std::int64_t i = 0; i < args.mean.count; ++i) {
            Eigen::Map<Eigen::MatrixXd> p(args.covariance.data + i * args.covariance.item_stride, n, n);
            if (DEFECT("estimator-summary-is-moments-in-cartesian")) diagonal_alone(p);
            if (NEAR_MISS("estimator-summary-is-moments-in-cartesian")) p *= 1 + 1e-12;
        }
        return status;
    }

    plr_status assign(const plr_call& call, const plr_estimator_assign& args) const {
        return one_by_one(call, args.out.count, [&](const plr_call& one, std::int64_t i) {
            plr_estimator_assign step = args;
            step.record = pelorus::slice(args.record, i, 1);
            step.mean = pelorus::slice(args.mean, i, 1);
            step.covariance = pelorus::slice(args.covariance, i, 1);
            step.out = pelorus::slice(args.out, i, 1);
            const double updated = step.record.data[n + n * n], predictions = step.record.data[n + n * n + 1];
            const plr_status status = Base::assign(one, step);
            if (status != PLR_OK) return status;
            Eigen::Map<Eigen::MatrixXd> p(step.out.data + n, n, n);
            if (DEFECT("estimator-assign-sets-moments")) diagonal_alone(p);
            if (NEAR_MISS("estimator-assign-sets-moments")) p *= 1 + 1e-12;
            step.out.data[n + n * n] = updated;
            step.out.data[n + n * n + 1] = predictions;
            return status;
        });
    }

    plr_status mix(const plr_call& call, const plr_estimator_mix_args& args) const {
        const plr_status status = Base::mix(call, args);
        if (status < 0) return status;
        for (std::int64_t i = 0; i < args.out.count; ++i) {
            double* const out = args.out.data + i * args.out.item_stride;
            const double* const first = args.records.data + i * args.records.item_stride;
            std::copy_n(first + n + n * n, further, out + n + n * n);
            Eigen::Map<Eigen::MatrixXd> p(out + n, n, n);
            if (NEAR_MISS("estimator-mixture-matches-moments")) p *= 1 + 1e-12;
            if (!DEFECT("estimator-mixture-matches-moments")) continue;
            p.setZero();  // and the spread of the means forgotten
            for (std::int64_t k = 0; k < args.records.cols; ++k)
                p += pelorus::item(args.weights, i)(k, 0) *
                     Eigen::Map<const Eigen::MatrixXd>(first + k * args.records.col_stride + n, n, n);
        }
        return status;
    }

    const void* extension(const char* id) const noexcept {
        static constexpr const char* names[] = {"calm", "agile"};
        static constexpr plr_estimator_modes modes{sizeof(plr_estimator_modes), 2, names, &Saboteur::probabilities};
        return std::strcmp(id, PLR_ESTIMATOR_MODES) == 0 ? static_cast<const void*>(&modes) : Base::extension(id);
    }

private:
    static plr_status probabilities(const void* self, const plr_call* call, const plr_const_view* record,
                                    const plr_view* out) noexcept {
        const auto& own = *static_cast<const Saboteur*>(self);
        return pelorus::guarded(call->error, [&] {
            pelorus::expect(*out, 2, 1, out->count, "out");
            pelorus::expect(*record, own.info.record_size, 1, out->count, "record");
            return pelorus::for_items(*call, out->count, [&](std::int64_t i) {
                const double calm = 1 / (1 + std::exp(-own.read(*record, i).mean(own.n - 1) / 100));
                double agile = 1 - calm;
                if (DEFECT("estimator-mode-probabilities")) agile *= 0.9;
                if (NEAR_MISS("estimator-mode-probabilities")) agile *= 1 + 1e-12;
                put(*out, i, Bounded<2, 1>((Bounded<2, 1>(2, 1) << calm, agile).finished()));
            });
        });
    }

    /// What the posterior may be instead.
    void distort(const Moments& before, const MeasurementMatrix& s, double updated, double log_likelihood,
                 Moments& after) const {
        double share = 1;
        if (DEFECT("estimator-updates-as-textbook")) share = 0.9;
        if (NEAR_MISS("estimator-updates-as-textbook")) share = 1 - 1e-10;
        if (updated > 0 && DEFECT("estimator-order-of-sensors-free")) share = 0.9;
        if (updated > 0 && NEAR_MISS("estimator-order-of-sensors-free")) share = 1 - 1e-10;
        if (share < 1) after.mean = (before.mean + share * (after.mean - before.mean)).eval();
        if (NEAR_MISS("estimator-survives-huge-prior")) after.covariance *= 1 + 1e-10;
        if (DEFECT("estimator-survives-huge-prior")) {  // P - K S K', for positions measured directly
            const Eigen::Index m = s.rows();
            const Cross gain = s.llt().solve(before.covariance.topRows(m)).transpose();
            after.covariance = before.covariance - gain * s * gain.transpose();
            symmetrise(after.covariance);
        }
        if (DEFECT("estimator-far-measurement-is-finite-or-flagged")) {  // a weight that is normalised
            const double likelihood = std::exp(log_likelihood);
            after.mean *= likelihood / likelihood;
        }
    }
    /// Takes Q off a predicted covariance.
    void without_noise(const plr_call& one, double dt, double* record) const {
        StateVector state = Eigen::Map<const StateVector>(record, n, 1);
        StateMatrix q(n, n);
        auto noise = pelorus::arguments<plr_motion_noise>();
        noise.dt = pelorus::const_view(&dt, 1, 1, 1);
        noise.state = noise.predicted = pelorus::const_view(state);
        noise.covariance = pelorus::const_view(record + n, n, n, 1);
        noise.out = pelorus::view(q);
        pelorus::require(motion.call(&plr_motion::noise, one, noise));
        Eigen::Map<StateMatrix>(record + n, n, n) -= q;
    }
    void know_velocity_to(double deviation) {
        std::vector<pelorus::Component> components = space.components();
        components.back().prior_deviation = deviation;
        space = pelorus::Space(components);
        info.state = info.cartesian = space.c();
    }
    std::int32_t nearest(std::int32_t sensor) const noexcept {
        return std::max(0, std::min(sensor, static_cast<std::int32_t>(sensors.size()) - 1));
    }
    static void diagonal_alone(Eigen::Map<Eigen::MatrixXd>& p) {
        for (Eigen::Index c = 0; c < p.cols(); ++c)
            for (Eigen::Index r = 0; r < p.rows(); ++r) p(r, c) *= r == c ? 1 : 0;
    }
    static plr_status failed(const plr_call& one, const char* why) {
        return pelorus::for_items(one, 1, [&](std::int64_t) { throw pelorus::NumericError(why); });
    }
    static plr_status all_failed(const plr_call& call, std::int64_t count) {
        return pelorus::for_items(call, count,
                                  [](std::int64_t) { throw pelorus::ArgumentError("sensor: there is none like it"); });
    }
    /// Calls for single items, put together to the answer of a batch.
    template <class Body> static plr_status one_by_one(const plr_call& call, std::int64_t count, Body&& body) {
        plr_status result = PLR_OK;
        for (std::int64_t i = 0; i < count; ++i) {
            const plr_status status = body(pelorus::slice(call, i), i);
            if (status < 0) return status;
            if (status != PLR_OK) result = status;
        }
        return result;
    }

    std::vector<std::string> names_;
    pelorus::Space told_;
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.estimator.saboteur");
