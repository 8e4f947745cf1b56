#include "pairing.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace calibration {

namespace {

constexpr double nanosecond = 1e-9;

double squared_distance(const Eigen::VectorXd& e, const Eigen::MatrixXd& covariance) {
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    if (factor.info() != Eigen::Success) throw pelorus::NumericError("a covariance is not positive definite");
    return e.dot(factor.solve(e));
}

class Pairing {
public:
    Pairing(pelorus::Caller& caller, const Believed& believed, const PairingRule& rule, const std::deque<Frame>& frames,
            double shared)
        : caller_(caller),
          sensor_(believed.sensor),
          believed_(believed),
          rule_(rule),
          frames_(frames),
          shared_(shared) {}

    std::optional<Pair> operator()(const std::vector<Fix>& fixes, std::size_t index) {
        const Fix& fix = fixes[index];
        const BiasVector mean = believed_.biases.mean();
        centre_ = fix.time + std::llround(mean(clock_offset) * 1e9);
        if (!find_frames()) return {};
        const Sample* const seed = only_candidate(fixes, index, mean);
        if (seed == nullptr) return {};
        chosen_.assign(1, seed);
        // The slope of measurement space there turns a speed into what may change from frame to frame.
        slope_ = sensor_.biased_jacobian(caller_, fix.position, believed_.pose, mean);
        follow(-1);
        std::reverse(chosen_.begin(), chosen_.end());
        follow(+1);
        const bool surrounds = chosen_.front()->time <= centre_ && chosen_.back()->time >= centre_;
        if (!surrounds || chosen_.size() < least_for_fit) return {};
        const Fit fit = fitted(*seed);
        if (fit.squared > fit.freedom + 6 * std::sqrt(2.0 * fit.freedom) + 6) return {};
        return difference(fix, mean, *seed, fit);
    }

private:
    /// Those within the window, and the one nearest its centre.
    bool find_frames() {
        const auto before = [](const Frame& frame, std::int64_t time) { return frame.time < time; };
        const auto after = [](std::int64_t time, const Frame& frame) { return time < frame.time; };
        first_ = std::lower_bound(frames_.begin(), frames_.end(), centre_ - rule_.window / 2, before) - frames_.begin();
        last_ = std::upper_bound(frames_.begin(), frames_.end(), centre_ + rule_.window / 2, after) - frames_.begin();
        if (last_ - first_ < least_for_fit) return false;
        nearest_ = first_;
        for (auto i = first_; i < last_; ++i)
            if (std::abs(frame(i).time - centre_) < std::abs(frame(nearest_).time - centre_)) nearest_ = i;
        return true;
    }

    /// The only measurement of the nearest frame that may be of this fix and of no other; nullptr: there is none.
    const Sample* only_candidate(const std::vector<Fix>& fixes, std::size_t index, const BiasVector& mean) {
        const Sample* found = nullptr;
        for (std::size_t k = 0; k < fixes.size(); ++k) {
            const Eigen::VectorXd expected = sensor_.biased(caller_, fixes[k].position, believed_.pose, mean);
            const Eigen::MatrixXd slope = sensor_.biased_jacobian(caller_, fixes[k].position, believed_.pose, mean);
            const BiasSlope over = sensor_.bias_slope(caller_, fixes[k].position, believed_.pose, mean);
            const double moved = rule_.maximum_speed * static_cast<double>(frame(nearest_).time - centre_) * nanosecond;
            Eigen::MatrixXd spread = slope * fixes[k].covariance * slope.transpose() +
                                     over * believed_.biases.covariance() * over.transpose() +
                                     slope * slope.transpose() * (moved * moved);
            for (const Sample& sample : frame(nearest_).samples) {
                const Eigen::MatrixXd covariance = spread + Eigen::MatrixXd(sample.variances.asDiagonal());
                const Eigen::VectorXd e = sensor_.residual(caller_, sample.value, expected);
                if (squared_distance(e, covariance) > rule_.gate * rule_.gate) continue;
                if (k == index && found != nullptr) return nullptr;
                if (k == index)
                    found = &sample;
                else if (fixes[k].id != fixes[index].id)
                    others_.push_back(&sample);
            }
        }
        const bool is_shared = std::find(others_.begin(), others_.end(), found) != others_.end();
        return is_shared ? nullptr : found;
    }

    /// Appends what continues the chain through the frames before (-1) or after (+1) the nearest one, up to the first frame
    /// that holds two such measurements. A frame without any is passed over.
    void follow(int direction) {
        for (auto i = nearest_ + direction; i >= first_ && i < last_; i += direction) {
            const Sample& from = *chosen_.back();
            const Sample* found = nullptr;
            for (const Sample& sample : frame(i).samples) {
                const double moved = rule_.maximum_speed * static_cast<double>(sample.time - from.time) * nanosecond;
                const Eigen::VectorXd variances = from.variances + sample.variances;
                const Eigen::MatrixXd covariance =
                    slope_ * slope_.transpose() * (moved * moved) + Eigen::MatrixXd(variances.asDiagonal());
                const Eigen::VectorXd e = sensor_.residual(caller_, sample.value, from.value);
                if (squared_distance(e, covariance) > rule_.gate * rule_.gate) continue;
                if (found != nullptr) return;
                found = &sample;
            }
            if (found != nullptr) chosen_.push_back(found);
        }
    }

    Fit fitted(const Sample& reference) {
        FitInput input;
        const auto n = static_cast<Eigen::Index>(chosen_.size());
        input.values.resize(sensor_.space().size(), n);
        input.variances.resize(sensor_.space().size(), n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const Sample& sample = *chosen_[static_cast<std::size_t>(i)];
            input.times.push_back(static_cast<double>(sample.time - centre_) * nanosecond);
            input.values.col(i) = sensor_.residual(caller_, sample.value, reference.value);
            input.variances.col(i) = sample.variances;
        }
        return local_fit(input);
    }

    std::optional<Pair> difference(const Fix& fix, const BiasVector& mean, const Sample& reference, const Fit& fit) {
        Pair out;
        const Eigen::VectorXd expected = sensor_.biased(caller_, fix.position, believed_.pose, mean);
        out.difference = sensor_.residual(caller_, reference.value, expected) + fit.value;
        out.noise = slope_ * fix.covariance * slope_.transpose();
        out.noise.diagonal() += shared_ * fit.value_variance;
        out.slope = sensor_.bias_slope(caller_, fix.position, believed_.pose, mean);
        for (Eigen::Index c = 0; c < fit.rate.size(); ++c) {
            const double square = fit.rate(c) * fit.rate(c);
            const double sure = square > fit.rate_variance(c) ? 1 - fit.rate_variance(c) / square : 0;
            out.slope(c, clock_offset) = -sure * fit.rate(c);
        }
        out.covariance = out.noise + out.slope * believed_.biases.covariance() * out.slope.transpose();
        if (squared_distance(out.difference, out.covariance) > rule_.gate * rule_.gate) return {};
        return out;
    }

    const Frame& frame(std::ptrdiff_t i) const { return frames_[static_cast<std::size_t>(i)]; }

    pelorus::Caller& caller_;
    const SensorModel& sensor_;
    const Believed& believed_;
    const PairingRule& rule_;
    const std::deque<Frame>& frames_;
    double shared_;
    std::int64_t centre_ = 0;
    std::ptrdiff_t first_ = 0, last_ = 0, nearest_ = 0;
    Eigen::MatrixXd slope_;
    std::vector<const Sample*> chosen_, others_;
};

}  // namespace

std::optional<Pair> pair_up(pelorus::Caller& caller, const Believed& believed, const PairingRule& rule,
                            const std::deque<Frame>& frames, const std::vector<Fix>& fixes, std::size_t index,
                            double shared) {
    return Pairing(caller, believed, rule, frames, shared)(fixes, index);
}

}  // namespace calibration
