/// An extent that owns the kinematics, too (extension `joint`).
#pragma once

#include <vector>

#include "target_filter.hpp"

namespace extended {

class JointFilter final : public TargetFilter {
public:
    JointFilter(const pelorus::ExtentPart& extent, const plr_extent_joint& joint)
        : TargetFilter(extent), joint_(joint) {
        describe(*joint.cartesian, joint.sensors, joint.sensor_count, "extent");
        version_ = plr_mix_version(joint_records, extent_info().record_version);
    }

    Records start(pelorus::Caller& caller, const Look& look, const std::vector<const Points*>& scans,
                  const Moments& moments) const override {
        Moments all = moments;
        for (int c = 0; c < space_.size(); ++c)
            if (derivative(c) < 0) {
                all.mean(c) = space_[c].prior_mean;
                all.covariance(c, c) = space_[c].prior_deviation * space_[c].prior_deviation;
            }
        return begin_record(caller, look, scans, all.mean, pelorus::const_view(all.covariance));
    }

    Records start_differenced(pelorus::Caller& caller, const Look& look, const std::vector<const Points*>& scans,
                              const Eigen::VectorXd& mean) const override {
        Eigen::VectorXd all = mean;
        for (int c = 0; c < space_.size(); ++c)
            if (derivative(c) < 0 || derivative(c) > 1) all(c) = space_[c].prior_mean;
        return begin_record(caller, look, scans, all, pelorus::absent_view());
    }

    void predict(pelorus::Caller& caller, const Look& look, double dt, Records& records) const override {
        auto args = pelorus::arguments<plr_joint_predict>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.record = input(records.extent);
        args.out = output(records.extent);
        caller.require(joint_.predict(extent_.self(), &begin(caller, look), &args), "extent, predict");
    }

    Update update(pelorus::Caller& caller, const Look& look, const Points& points, Records& records) const override {
        const PointsView scan(points);
        double log_likelihood = 0;
        Eigen::VectorXd innovation(dimension());
        Eigen::MatrixXd covariance(dimension(), dimension());
        auto args = pelorus::arguments<plr_joint_update>();
        args.scan = scan.c();
        args.record = input(records.extent);
        args.out = output(records.extent);
        args.log_likelihood = pelorus::view(&log_likelihood, 1, 1, 1);
        args.innovation = pelorus::view(innovation);
        args.innovation_covariance = pelorus::view(covariance);
        caller.require(joint_.update(extent_.self(), &begin(caller, look), &args), "extent, update");
        return {log_likelihood, squared_innovation(innovation, covariance)};
    }

    Moments summary(pelorus::Caller& caller, const Look& look, const Records& records) const override {
        Moments out{Eigen::VectorXd(space_.size()), Eigen::MatrixXd(space_.size(), space_.size())};
        auto args = pelorus::arguments<plr_joint_summary>();
        args.record = input(records.extent);
        args.mean = pelorus::view(out.mean);
        args.covariance = pelorus::view(out.covariance);
        caller.require(joint_.summary(extent_.self(), &begin(caller, look), &args), "extent, summary");
        return out;
    }

    std::vector<double> distances(pelorus::Caller& caller, const Look& look, const Points& points,
                                  const Records& records) const override {
        std::vector<double> out(points.ids.size());
        const PointsView scan(points);
        auto args = pelorus::arguments<plr_extent_gate>();
        args.record = input(records.extent);
        args.scan = scan.c();
        args.squared_distance = pelorus::view(out.data(), 1, 1, points.count());
        caller.require(joint_.gate(extent_.self(), &begin(caller, look), &args), "extent, gate");
        return out;
    }

private:
    /// Tells saved joint records from those of an estimator and an extent whose versions happen to fold to the same number.
    static constexpr std::uint32_t joint_records = 0x4a4f494e;

    Records begin_record(pelorus::Caller& caller, const Look& look, const std::vector<const Points*>& scans,
                         const Eigen::VectorXd& mean, const plr_const_view& covariance) const {
        Records records{{}, std::vector<double>(extent_size())};
        const StartScans given(scans);
        auto args = pelorus::arguments<plr_joint_init>();
        args.scans = static_cast<std::uint32_t>(scans.size());
        args.scan = given.raw.data();
        args.times = given.time_view();
        args.mean = pelorus::const_view(mean);
        args.covariance = covariance;
        args.record = output(records.extent);
        caller.require(joint_.init(extent_.self(), &begin(caller, look), &args), "extent, init");
        return records;
    }

    const plr_extent_joint& joint_;
};

}  // namespace extended
