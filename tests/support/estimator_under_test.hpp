// An estimator plugin's answers, one item or a batch at a time.
#pragma once

#include "plugin_instance.hpp"

namespace test_support {

class EstimatorUnderTest {
public:
    explicit EstimatorUnderTest(const Instance& instance) : part_(instance.as<pelorus::EstimatorPart>()) {}

    const pelorus::EstimatorPart& part() const noexcept { return part_; }
    const plr_estimator_info& info() const noexcept { return part_.info(); }
    std::int64_t record_size() const noexcept { return info().record_size; }
    std::int64_t n() const noexcept { return info().state->size; }
    std::int64_t c() const noexcept { return info().cartesian->size; }
    std::int64_t m(std::int32_t sensor) const {
        return pelorus::SensorPart(info().sensors[sensor]).info().measurement->size;
    }

    plr_status init(Call& call, const std::vector<std::int32_t>& components, Batch& mean, Batch& covariance,
                    Batch& record) const {
        auto args = pelorus::arguments<plr_estimator_init>();
        args.known = static_cast<std::uint32_t>(components.size());
        args.components = components.data();
        args.mean = mean.in();
        args.covariance = covariance.in();
        args.record = record.out();
        return part_.call(&plr_estimator::init, call, args);
    }
    plr_status predict(Call& call, const plr_const_view& dt, const Batch& record, Batch& out) const {
        auto args = pelorus::arguments<plr_estimator_predict>();
        args.dt = dt;
        args.record = record.in();
        args.out = out.out();
        return part_.call(&plr_estimator::predict, call, args);
    }
    plr_status project(Call& call, std::int32_t sensor, const Batch& record, Batch& measurement, Batch& covariance,
                       Batch& cross, Batch* cartesian_cross = nullptr) const {
        auto args = pelorus::arguments<plr_estimator_project>();
        args.sensor = sensor;
        args.record = record.in();
        args.measurement = measurement.out();
        args.covariance = covariance.out();
        args.cross = cross.out();
        if (cartesian_cross != nullptr) args.cartesian_cross = cartesian_cross->out();
        return part_.call(&plr_estimator::project, call, args);
    }
    /// What an update tells besides the new record.
    struct Told {
        Told(std::int64_t m, std::int64_t count)
            : log_likelihood(1, 1, count), innovation(m, 1, count), covariance(m, m, count) {}
        Batch log_likelihood, innovation, covariance;
    };
    plr_status update(Call& call, std::int32_t sensor, const Batch& record, const Batch& measurement,
                      const plr_const_view& noise, Batch& out, Told& told) const {
        auto args = pelorus::arguments<plr_estimator_update>();
        args.sensor = sensor;
        args.record = record.in();
        args.measurement = measurement.in();
        args.noise = noise;
        args.out = out.out();
        args.log_likelihood = told.log_likelihood.out();
        args.innovation = told.innovation.out();
        args.innovation_covariance = told.covariance.out();
        return part_.call(&plr_estimator::update, call, args);
    }
    plr_status moments(Call& call, const Batch& record, Batch& mean, Batch& covariance) const {
        return tell(call, &plr_estimator::moments, record, mean, covariance);
    }
    plr_status summary(Call& call, const Batch& record, Batch& mean, Batch& covariance) const {
        return tell(call, &plr_estimator::summary, record, mean, covariance);
    }
    plr_status assign(Call& call, const Batch& record, const Batch& mean, const Batch& covariance, Batch& out) const {
        auto args = pelorus::arguments<plr_estimator_assign>();
        args.record = record.in();
        args.mean = mean.in();
        args.covariance = covariance.in();
        args.out = out.out();
        return part_.call(&plr_estimator::assign, call, args);
    }

    /// A record of given native moments.
    Batch record_of(const Eigen::VectorXd& x, const Eigen::MatrixXd& p) const {
        Call call;
        Batch known(c(), 1), spread(c(), c()), record(record_size(), 1), mean(n(), 1), covariance(n(), n());
        std::vector<std::int32_t> all;
        for (std::int32_t k = 0; k < c(); ++k) all.push_back(k);
        known[0].setOnes();
        spread[0].setIdentity();
        mean[0] = x;
        covariance[0] = p;
        if (init(call, all, known, spread, record) != PLR_OK ||
            assign(call, record, mean, covariance, record) != PLR_OK)
            throw std::runtime_error(call.message());
        return record;
    }

private:
    template <class Function>
    plr_status tell(Call& call, Function function, const Batch& record, Batch& mean, Batch& covariance) const {
        auto args = pelorus::arguments<plr_estimator_moments>();
        args.record = record.in();
        args.mean = mean.out();
        args.covariance = covariance.out();
        return part_.call(function, call, args);
    }

    pelorus::EstimatorPart part_;
};

}  // namespace test_support
