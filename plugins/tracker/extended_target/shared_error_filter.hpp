/// Whether the points of a scan have errors of their own or one in common: one filter for each answer, side by side.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "../../common/extended/separate_filter.hpp"

namespace extended_target {

using namespace extended;

/// Each hypothesis takes a share s of the sensor's noise R to be one error of all points of a scan: a point then has (1 - s) R of
/// its own, and the centroid keeps s R however many points there are. The likelihood of the centroids tells which is right.
/// Records: [ln of the weights (h), the records of each].
class SharedErrorFilter final : public TargetFilter {
public:
    SharedErrorFilter(const pelorus::EstimatorPart& estimator, const pelorus::ExtentPart& extent,
                      std::vector<double> shares)
        : TargetFilter(extent), inner_(estimator, extent), shares_(std::move(shares)) {
        take_space(inner_);
        kinematics_size_ = shares_.size() * (1 + inner_.kinematics_size());
        extent_size_ = shares_.size() * inner_.extent_size();
        version_ = plr_mix_version(static_cast<std::uint32_t>(shares_.size()), inner_.record_version());
    }

    Records start(pelorus::Caller& caller, const Look& look, const std::vector<const Points*>& scans,
                  const Moments& moments) const override {
        return started(scans, [&](const std::vector<const Points*>& shared) {
            return inner_.start(caller, look, shared, moments);
        });
    }
    Records start_differenced(pelorus::Caller& caller, const Look& look, const std::vector<const Points*>& scans,
                              const Eigen::VectorXd& mean) const override {
        return started(scans, [&](const std::vector<const Points*>& shared) {
            return inner_.start_differenced(caller, look, shared, mean);
        });
    }

    void predict(pelorus::Caller& caller, const Look& look, double dt, Records& records) const override {
        for (std::size_t h = 0; h < shares_.size(); ++h) {
            Records own = records_of(records, h);
            inner_.predict(caller, look, dt, own);
            put(own, h, records);
        }
    }

    /// The innovation is that of the likeliest hypothesis.
    Update update(pelorus::Caller& caller, const Look& look, const Points& points, Records& records) const override {
        const std::size_t likeliest = likeliest_of(records);
        std::vector<double> logs;
        double squared = 0;
        for (std::size_t h = 0; h < shares_.size(); ++h) {
            Records own = records_of(records, h);
            const Update one = inner_.update(caller, look, points.with_common(shares_[h]), own);
            logs.push_back(records.kinematics[h] + one.log_likelihood);
            if (h == likeliest) squared = one.squared_innovation;
            put(own, h, records);
        }
        const double total = log_sum(logs);
        if (!std::isfinite(total)) throw pelorus::NumericError("no share of a common error explains the points");
        // Never so small that a sensor that changes could not be noticed.
        for (double& log : logs) log = std::max(log - total, std::log(least_weight));
        const double kept = log_sum(logs);
        for (std::size_t h = 0; h < shares_.size(); ++h) records.kinematics[h] = logs[h] - kept;
        return {total, squared};
    }

    Moments summary(pelorus::Caller& caller, const Look& look, const Records& records) const override {
        std::vector<Moments> each;
        for (std::size_t h = 0; h < shares_.size(); ++h)
            each.push_back(inner_.summary(caller, look, records_of(records, h)));
        Moments out{0 * each[0].mean, 0 * each[0].covariance};
        for (std::size_t h = 0; h < shares_.size(); ++h) out.mean += weight(records, h) * each[h].mean;
        for (std::size_t h = 0; h < shares_.size(); ++h) {
            const Eigen::VectorXd apart = each[h].mean - out.mean;
            out.covariance += weight(records, h) * (each[h].covariance + apart * apart.transpose());
        }
        return out;
    }

    Eigen::MatrixXd shape(pelorus::Caller& caller, const Look& look, const Records& records) const override {
        Eigen::MatrixXd out = Eigen::MatrixXd::Zero(dimension(), dimension());
        for (std::size_t h = 0; h < shares_.size(); ++h)
            out += weight(records, h) * inner_.shape(caller, look, records_of(records, h));
        return out;
    }

    /// Those of the likeliest hypothesis.
    std::vector<double> distances(pelorus::Caller& caller, const Look& look, const Points& points,
                                  const Records& records) const override {
        const std::size_t h = likeliest_of(records);
        return inner_.distances(caller, look, points.with_common(shares_[h]), records_of(records, h));
    }

private:
    static constexpr double least_weight = 1e-6;

    std::size_t likeliest_of(const Records& records) const {
        const auto logs = records.kinematics.begin();
        return static_cast<std::size_t>(std::max_element(logs, logs + static_cast<std::ptrdiff_t>(shares_.size())) -
                                        logs);
    }
    static double weight(const Records& records, std::size_t h) { return std::exp(records.kinematics[h]); }
    static double log_sum(const std::vector<double>& logs) {
        const double largest = *std::max_element(logs.begin(), logs.end());
        double sum = 0;
        for (const double log : logs) sum += std::exp(log - largest);
        return largest + std::log(sum);
    }

    template <class Start> Records started(const std::vector<const Points*>& scans, Start start) const {
        Records records{std::vector<double>(kinematics_size_), std::vector<double>(extent_size_)};
        for (std::size_t h = 0; h < shares_.size(); ++h) {
            std::vector<Points> shared;
            for (const Points* scan : scans) shared.push_back(scan->with_common(shares_[h]));
            std::vector<const Points*> given;
            for (const Points& scan : shared) given.push_back(&scan);
            put(start(given), h, records);
            records.kinematics[h] = -std::log(static_cast<double>(shares_.size()));
        }
        return records;
    }

    std::ptrdiff_t kinematics_at(std::size_t h) const {
        return static_cast<std::ptrdiff_t>(shares_.size() + h * inner_.kinematics_size());
    }
    std::ptrdiff_t extent_at(std::size_t h) const { return static_cast<std::ptrdiff_t>(h * inner_.extent_size()); }
    Records records_of(const Records& all, std::size_t h) const {
        const auto k = all.kinematics.begin() + kinematics_at(h), e = all.extent.begin() + extent_at(h);
        return {{k, k + static_cast<std::ptrdiff_t>(inner_.kinematics_size())},
                {e, e + static_cast<std::ptrdiff_t>(inner_.extent_size())}};
    }
    void put(const Records& own, std::size_t h, Records& all) const {
        std::copy(own.kinematics.begin(), own.kinematics.end(), all.kinematics.begin() + kinematics_at(h));
        std::copy(own.extent.begin(), own.extent.end(), all.extent.begin() + extent_at(h));
    }

    SeparateFilter inner_;
    std::vector<double> shares_;
};

}  // namespace extended_target
