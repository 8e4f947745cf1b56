// A plain cubature filter that drives a motion plugin through its table, in the order of calls that abi/motion.h lays down, records
// included: an estimator that shares no line with the framework's own.
#pragma once

#include <functional>

#include "motion_checks.hpp"
#include "reference.hpp"

namespace test_support {

class MotionFilter {
public:
    MotionFilter(const Instance& instance, Eigen::VectorXd mean, Eigen::MatrixXd covariance)
        : part_(instance.as<pelorus::MotionPart>()), mean_(std::move(mean)), covariance_(std::move(covariance)) {
        if (mean_.size() != part_.info().state->size) throw std::runtime_error("the start has another size");
        record_.setZero(part_.info().record_size);
        if (record_.size() > 0) remember(&plr_motion::init_record, nullptr);
    }

    const Eigen::VectorXd& mean() const noexcept { return mean_; }
    const Eigen::MatrixXd& covariance() const noexcept { return covariance_; }
    const Eigen::VectorXd& record() const noexcept { return record_; }
    const Eigen::MatrixXd& process_noise() const noexcept { return noise_; }  ///< of the last prediction

    /// Points (columns) about the mean, dt later.
    Eigen::MatrixXd moved(double dt, const Eigen::MatrixXd& points) const {
        const Eigen::Index n = mean_.size();
        Eigen::MatrixXd out(n, points.cols());
        auto args = pelorus::arguments<plr_motion_propagate>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.state = pelorus::const_view(points);
        args.record = pelorus::const_view(record_.data(), record_.size(), 1, 1);
        args.mean = pelorus::const_view(mean_);
        args.out = pelorus::view(out);
        made(&plr_motion::propagate, args);
        return out;
    }
    Eigen::MatrixXd jacobian(double dt) const {
        const Eigen::Index n = mean_.size();
        Eigen::MatrixXd out(n, n);
        auto args = pelorus::arguments<plr_motion_jacobian>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.state = args.mean = pelorus::const_view(mean_);
        args.record = pelorus::const_view(record_.data(), record_.size(), 1, 1);
        args.out = pelorus::view(out);
        made(&plr_motion::jacobian, args);
        return out;
    }
    Eigen::MatrixXd noise(double dt, const Eigen::VectorXd& predicted) const {
        Eigen::MatrixXd out(mean_.size(), mean_.size());
        const plr_motion_noise args = noise_arguments(dt, predicted, pelorus::view(out));
        made(&plr_motion::noise, args);
        return out;
    }
    /// G of the noise factor extension, which must be there.
    Eigen::MatrixXd noise_factor(double dt, const Eigen::VectorXd& predicted) const {
        const auto& extension = *part_.extension<plr_motion_noise_factor>(PLR_MOTION_NOISE_FACTOR);
        Eigen::MatrixXd out(mean_.size(), extension.columns);
        const plr_motion_noise args = noise_arguments(dt, predicted, pelorus::view(out));
        Call call;
        if (extension.factor(part_.self(), &static_cast<const plr_call&>(call), &args) != PLR_OK)
            throw std::runtime_error(call.message());
        return out;
    }

    void predict(double dt) {
        const Eigen::Index n = mean_.size();
        const Eigen::MatrixXd points = moved(dt, drawn());
        const Eigen::VectorXd predicted = points.rowwise().mean();
        noise_ = noise(dt, moved(dt, mean_));
        const Eigen::MatrixXd spread = points.colwise() - predicted;
        if (record_.size() > 0) remember(&plr_motion::advance_record, &dt);
        mean_ = predicted;
        covariance_ = spread * spread.transpose() / static_cast<double>(2 * n) + noise_;
    }

    /// Takes these moments for the posterior of an update.
    void put(Eigen::VectorXd mean, Eigen::MatrixXd covariance) {
        mean_ = std::move(mean);
        covariance_ = std::move(covariance);
    }
    /// The order of the components in which the square root of the covariance is taken. Cubature points, and with them what a bent
    /// measurement makes of them beyond second order, depend on it.
    void draw_in_order(std::vector<int> components) { order_ = std::move(components); }

    /// A measurement z = h(x) + noise of covariance r; `wrap` brings a residual into its range.
    void update(const Eigen::VectorXd& z, const Eigen::MatrixXd& r,
                const std::function<Eigen::VectorXd(const Eigen::VectorXd&)>& h,
                const std::function<void(Eigen::VectorXd&)>& wrap) {
        const Eigen::Index n = mean_.size();
        const Eigen::MatrixXd points = drawn();
        Eigen::MatrixXd measured(z.size(), 2 * n);
        for (Eigen::Index p = 0; p < 2 * n; ++p) measured.col(p) = h(points.col(p));
        const Eigen::VectorXd expected = measured.rowwise().mean();
        const Eigen::MatrixXd dz = measured.colwise() - expected, dx = points.colwise() - mean_;
        const double weight = 1.0 / static_cast<double>(2 * n);
        const Eigen::MatrixXd s = weight * dz * dz.transpose() + r, cross = weight * dx * dz.transpose();
        pelorus::small::Bounded<12, 12> innovation_covariance = s, factor = s, gain_transposed = cross.transpose();
        if (!pelorus::small::cholesky(innovation_covariance, factor)) throw std::runtime_error("S is not definite");
        pelorus::small::cholesky_solve(factor, gain_transposed);
        Eigen::VectorXd innovation = z - expected;
        wrap(innovation);
        mean_ += gain_transposed.transpose() * innovation;
        covariance_ -= gain_transposed.transpose() * s * gain_transposed;
    }

private:
    /// The 2n cubature points of the present moments.
    Eigen::MatrixXd drawn() const {
        const Eigen::Index n = mean_.size();
        std::vector<int> order = order_;
        for (int i = 0; order_.empty() && i < n; ++i) order.push_back(i);
        pelorus::small::Bounded<12, 12> covariance = reordered(covariance_, order, order), factor = covariance;
        if (!pelorus::small::cholesky(covariance, factor)) throw std::runtime_error("P is not definite");
        Eigen::MatrixXd offsets(n, n);
        for (Eigen::Index r = 0; r < n; ++r)
            offsets.row(order[static_cast<std::size_t>(r)]) = std::sqrt(static_cast<double>(n)) * factor.row(r);
        Eigen::MatrixXd points(n, 2 * n);
        points << offsets, -offsets;
        return points.colwise() + mean_;
    }
    plr_motion_noise noise_arguments(const double& dt, const Eigen::VectorXd& predicted, const plr_view& out) const {
        auto args = pelorus::arguments<plr_motion_noise>();
        args.dt = pelorus::const_view(&dt, 1, 1, 1);
        args.state = pelorus::const_view(mean_);
        args.covariance = pelorus::const_view(covariance_);
        args.predicted = pelorus::const_view(predicted);
        args.record = pelorus::const_view(record_.data(), record_.size(), 1, 1);
        args.out = out;
        return args;
    }
    template <class Function, class Args> void made(Function function, const Args& args) const {
        Call call;
        if (part_.call(function, call, args) != PLR_OK) throw std::runtime_error(call.message());
    }
    /// init_record (dt nullptr) or advance_record, in place.
    template <class Function> void remember(Function function, const double* dt) {
        auto args = pelorus::arguments<plr_motion_record>();
        args.state = pelorus::const_view(mean_);
        args.covariance = pelorus::const_view(covariance_);
        if (dt != nullptr) {
            args.dt = pelorus::const_view(dt, 1, 1, 1);
            args.record = pelorus::const_view(record_.data(), record_.size(), 1, 1);
        }
        args.out = pelorus::view(record_);
        made(function, args);
    }

    pelorus::MotionPart part_;
    Eigen::VectorXd mean_, record_;
    Eigen::MatrixXd covariance_, noise_;
    std::vector<int> order_;  // empty: as they stand
};

}  // namespace test_support
