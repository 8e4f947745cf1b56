/// A scan that is kept until it may go on: a copy of all that it carries.
#pragma once

#include "intake.hpp"

namespace streams {

class HeldScan {
public:
    HeldScan() = default;
    HeldScan(const plr_scan& scan, Clock time)
        : time_(time), sensor_(scan.sensor), place_(place_of(scan)), count_(scan.measurements.count) {
        values_ = packed(scan.measurements, count_);
        has_covariances_ = scan.covariances.data != nullptr;
        has_common_covariance_ = has_covariances_ && scan.covariances.item_stride == 0;
        if (has_covariances_) covariances_ = packed(scan.covariances, has_common_covariance_ ? 1 : count_);
        const auto n = static_cast<std::size_t>(count_);
        if (scan.ids != nullptr) ids_.assign(scan.ids, scan.ids + n);
        if (scan.times != nullptr) times_.assign(scan.times, scan.times + n);
        if (scan.snr.data != nullptr) snr_ = packed(scan.snr, count_);
        if (scan.waveform_space == nullptr || scan.waveform.data == nullptr) return;
        waveform_place_.space = pelorus::Space(*scan.waveform_space);
        waveform_ = packed(scan.waveform, 1);
    }

    Clock time() const noexcept { return time_; }

    /// Calls publish(message) with what was kept, to go out with the event being handled.
    template <class Publish> void release(Publish&& publish) const {
        const std::int64_t m = place_.space.size(), w = static_cast<std::int64_t>(waveform_.size());
        plr_const_view covariances = pelorus::absent_view();
        if (has_covariances_) covariances = pelorus::const_view(covariances_.data(), m, m, count_);
        if (has_common_covariance_) covariances.item_stride = 0;
        const plr_scan scan{sizeof(plr_scan),
                            0,
                            sensor_.c_str(),
                            place_.frame.c_str(),
                            place_.space.c(),
                            pelorus::const_view(values_.data(), m, 1, count_),
                            covariances,
                            ids_.empty() ? nullptr : ids_.data(),
                            times_.empty() ? nullptr : times_.data(),
                            snr_.empty() ? pelorus::absent_view() : pelorus::const_view(snr_.data(), 1, 1, count_),
                            w == 0 ? nullptr : waveform_place_.space.c(),
                            w == 0 ? pelorus::absent_view() : pelorus::const_view(waveform_.data(), w, 1, 1)};
        publish(passed_on(scan, time_));
    }

    template <class Archive> void state(Archive& archive) {
        archive(time_, sensor_, place_, count_, values_, has_covariances_, has_common_covariance_, covariances_, ids_,
                times_, snr_, waveform_place_, waveform_);
        if constexpr (Archive::reading) check_sizes();
    }

private:
    static std::vector<double> packed(const plr_const_view& view, std::int64_t count) {
        std::vector<double> numbers;
        numbers.reserve(static_cast<std::size_t>(view.rows * view.cols * count));
        for (std::int64_t i = 0; i < count; ++i) {
            const Eigen::MatrixXd one = pelorus::item(view, i);
            numbers.insert(numbers.end(), one.data(), one.data() + one.size());
        }
        return numbers;
    }
    void check_sizes() const {
        const auto m = static_cast<std::size_t>(place_.space.size()), n = static_cast<std::size_t>(count_);
        const std::size_t squares = !has_covariances_ ? 0 : has_common_covariance_ ? 1 : n;
        const auto none_or = [](std::size_t size, std::size_t whole) { return size == 0 || size == whole; };
        if (count_ < 0 || values_.size() != n * m || covariances_.size() != squares * m * m ||
            !none_or(ids_.size(), n) || !none_or(times_.size(), n) || !none_or(snr_.size(), n) ||
            waveform_.size() != static_cast<std::size_t>(waveform_place_.space.size()))
            throw pelorus::DataError("a saved scan is of other dimensions");
    }

    Clock time_ = 0;
    std::string sensor_;
    Place place_, waveform_place_;
    std::int64_t count_ = 0;
    std::vector<double> values_, covariances_, snr_, waveform_;
    bool has_covariances_ = false, has_common_covariance_ = false;
    std::vector<std::uint64_t> ids_;
    std::vector<std::int64_t> times_;
};

}  // namespace streams
