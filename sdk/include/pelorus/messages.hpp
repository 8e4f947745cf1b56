/// Messages in C++: builders that own what a plr_message points to, and helpers to read one that was received.
///
/// A builder's message() is valid until the builder is changed or dies; the host copies on publishing.
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <pelorus/abi/message.h>
#include <pelorus/matrix.hpp>
#include <pelorus/space.hpp>

namespace pelorus {

/// Item i of a view with packed columns, as an Eigen matrix (no copy).
using ConstMatrixMap = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>>;
inline ConstMatrixMap item(const plr_const_view& v, std::int64_t i) {
    return {v.data + i * v.item_stride, v.rows, v.cols, {v.col_stride, v.row_stride}};
}

namespace detail {

inline plr_message message_of(std::uint32_t kind, std::int64_t time) noexcept {
    plr_message m{};
    m.struct_size = sizeof m;
    m.kind = kind;
    m.time = time;
    m.arrival = std::numeric_limits<std::int64_t>::min();
    return m;
}

}  // namespace detail

/// One scan. Measurements are appended one by one.
class ScanBuilder {
public:
    ScanBuilder(std::string sensor, std::string frame, Space space)
        : sensor_(std::move(sensor)), frame_(std::move(frame)), space_(std::move(space)) {}

    void clear() {
        values_.clear();
        covariances_.clear();
        ids_.clear();
        times_.clear();
        snr_.clear();
        waveform_.clear();
    }
    /// Appends a measurement; the covariance (m x m) is given for all or for none.
    void add(std::uint64_t id, const double* measurement, const double* covariance = nullptr) {
        const auto m = static_cast<std::size_t>(space_.size());
        values_.insert(values_.end(), measurement, measurement + m);
        if (covariance != nullptr) covariances_.insert(covariances_.end(), covariance, covariance + m * m);
        ids_.push_back(id);
    }
    /// The time of the measurement added last, where it differs from the scan's: then for all.
    void set_time(std::int64_t time) { times_.push_back(time); }
    /// The signal-to-noise ratio (power) of the measurement added last: for all or for none.
    void set_snr(double snr) { snr_.push_back(snr); }
    void set_waveform(const Space& space, const std::vector<double>& parameters) {
        waveform_space_ = space;
        waveform_ = parameters;
    }
    std::int64_t count() const noexcept { return static_cast<std::int64_t>(ids_.size()); }

    const plr_message& message(std::int64_t time) {
        const std::int64_t n = count(), m = space_.size();
        scan_ = {sizeof(plr_scan),
                 0,
                 sensor_.c_str(),
                 frame_.c_str(),
                 space_.c(),
                 const_view(values_.data(), m, 1, n),
                 covariances_.empty() ? absent_view() : const_view(covariances_.data(), m, m, n),
                 ids_.data(),
                 times_.empty() ? nullptr : times_.data(),
                 snr_.empty() ? absent_view() : const_view(snr_.data(), 1, 1, n),
                 waveform_.empty() ? nullptr : waveform_space_.c(),
                 waveform_.empty() ? absent_view()
                                   : const_view(waveform_.data(), static_cast<std::int64_t>(waveform_.size()), 1, 1)};
        message_ = detail::message_of(PLR_MESSAGE_SCAN, time);
        message_.body.scan = &scan_;
        return message_;
    }

private:
    std::string sensor_, frame_;
    Space space_, waveform_space_;
    std::vector<double> values_, covariances_, snr_, waveform_;
    std::vector<std::uint64_t> ids_;
    std::vector<std::int64_t> times_;
    plr_scan scan_{};
    plr_message message_{};
};

/// Ragged lists of ids, one an entry.
class IdLists {
public:
    void clear() {
        offsets_.assign(1, 0);
        ids_.clear();
    }
    void add(const std::vector<std::uint64_t>& ids) {
        ids_.insert(ids_.end(), ids.begin(), ids.end());
        offsets_.push_back(static_cast<std::int64_t>(ids_.size()));
    }
    const std::int64_t* offsets() const noexcept { return offsets_.data(); }
    const std::uint64_t* ids() const noexcept { return ids_.data(); }
    std::size_t count() const noexcept { return ids_.size(); }

private:
    std::vector<std::int64_t> offsets_{0};
    std::vector<std::uint64_t> ids_;
};

/// One track at one time, as an entry of a tracks message.
struct TrackEntry {
    std::uint64_t id = 0;
    std::int64_t time = 0;  ///< ns
    std::int32_t status = PLR_TRACK_CONFIRMED;
    std::int32_t misses = 0;
    const double* mean = nullptr;        ///< c
    const double* covariance = nullptr;  ///< c x c
    const double* extent = nullptr;      ///< d x d; for all entries or for none
    std::vector<std::uint64_t> parents;
    std::uint64_t group = 0;  ///< 0: none
    std::vector<std::uint64_t> measurements;
    std::vector<double> distances;  ///< squared Mahalanobis, one a measurement; for all entries or for none
};

class TracksBuilder {
public:
    /// `extent_dimension` 0: tracks have no extent.
    TracksBuilder(std::string frame, Space space, int extent_dimension = 0)
        : frame_(std::move(frame)), space_(std::move(space)), extent_dimension_(extent_dimension) {}

    void clear() {
        mean_.clear();
        covariance_.clear();
        extent_.clear();
        ids_.clear();
        groups_.clear();
        times_.clear();
        status_.clear();
        misses_.clear();
        parents_.clear();
        measurements_.clear();
        distances_.clear();
        any_group_ = false;
    }
    void add(const TrackEntry& entry) {
        const auto c = static_cast<std::size_t>(space_.size()), d = static_cast<std::size_t>(extent_dimension_);
        ids_.push_back(entry.id);
        times_.push_back(entry.time);
        status_.push_back(entry.status);
        misses_.push_back(entry.misses);
        groups_.push_back(entry.group);
        any_group_ = any_group_ || entry.group != 0;
        mean_.insert(mean_.end(), entry.mean, entry.mean + c);
        covariance_.insert(covariance_.end(), entry.covariance, entry.covariance + c * c);
        if (d != 0) extent_.insert(extent_.end(), entry.extent, entry.extent + d * d);
        parents_.add(entry.parents);
        measurements_.add(entry.measurements);
        distances_.insert(distances_.end(), entry.distances.begin(), entry.distances.end());
    }
    std::int64_t count() const noexcept { return static_cast<std::int64_t>(ids_.size()); }
    const Space& space() const noexcept { return space_; }

    const plr_message& message(std::int64_t time) {
        const std::int64_t n = count(), c = space_.size(), d = extent_dimension_;
        if (!distances_.empty() && distances_.size() != measurements_.count())
            throw ArgumentError("distances are given for " + std::to_string(distances_.size()) + " of " +
                                std::to_string(measurements_.count()) + " measurements; give all or none");
        tracks_ = {sizeof(plr_tracks),
                   0,
                   n,
                   frame_.c_str(),
                   space_.c(),
                   ids_.data(),
                   times_.data(),
                   status_.data(),
                   misses_.data(),
                   const_view(mean_.data(), c, 1, n),
                   const_view(covariance_.data(), c, c, n),
                   d == 0 ? absent_view() : const_view(extent_.data(), d, d, n),
                   parents_.offsets(),
                   parents_.ids(),
                   any_group_ ? groups_.data() : nullptr,
                   measurements_.offsets(),
                   measurements_.ids(),
                   absent_view(),
                   nullptr,
                   distances_.empty() ? nullptr : distances_.data(),
                   nullptr};
        message_ = detail::message_of(PLR_MESSAGE_TRACKS, time);
        message_.body.tracks = &tracks_;
        return message_;
    }

private:
    std::string frame_;
    Space space_;
    int extent_dimension_;
    std::vector<double> mean_, covariance_, extent_, distances_;
    std::vector<std::uint64_t> ids_, groups_;
    std::vector<std::int64_t> times_;
    std::vector<std::int32_t> status_, misses_;
    IdLists parents_, measurements_;
    bool any_group_ = false;
    plr_tracks tracks_{};
    plr_message message_{};
};

/// One object at one time, as an entry of a truth message.
struct TruthEntry {
    std::uint64_t id = 0;
    std::int64_t time = 0;
    const double* state = nullptr;   ///< c
    const double* extent = nullptr;  ///< d x d; for all entries or for none
    std::uint64_t parent = 0;        ///< the entry's own id: none
    std::int64_t birth = 0;
    std::vector<std::uint64_t> measurements;
};

class TruthBuilder {
public:
    TruthBuilder(std::string frame, Space space, int extent_dimension = 0)
        : frame_(std::move(frame)), space_(std::move(space)), extent_dimension_(extent_dimension) {}

    void clear() {
        state_.clear();
        extent_.clear();
        ids_.clear();
        parents_.clear();
        times_.clear();
        births_.clear();
        measurements_.clear();
    }
    void add(const TruthEntry& entry) {
        const auto c = static_cast<std::size_t>(space_.size()), d = static_cast<std::size_t>(extent_dimension_);
        ids_.push_back(entry.id);
        times_.push_back(entry.time);
        parents_.push_back(entry.parent);
        births_.push_back(entry.birth);
        state_.insert(state_.end(), entry.state, entry.state + c);
        if (d != 0) extent_.insert(extent_.end(), entry.extent, entry.extent + d * d);
        measurements_.add(entry.measurements);
    }

    const plr_message& message(std::int64_t time) {
        const auto n = static_cast<std::int64_t>(ids_.size());
        const std::int64_t c = space_.size(), d = extent_dimension_;
        truth_ = {sizeof(plr_truth),
                  0,
                  n,
                  frame_.c_str(),
                  space_.c(),
                  ids_.data(),
                  times_.data(),
                  const_view(state_.data(), c, 1, n),
                  d == 0 ? absent_view() : const_view(extent_.data(), d, d, n),
                  parents_.data(),
                  births_.data(),
                  measurements_.offsets(),
                  measurements_.ids()};
        message_ = detail::message_of(PLR_MESSAGE_TRUTH, time);
        message_.body.truth = &truth_;
        return message_;
    }

private:
    std::string frame_;
    Space space_;
    int extent_dimension_;
    std::vector<double> state_, extent_;
    std::vector<std::uint64_t> ids_, parents_;
    std::vector<std::int64_t> times_, births_;
    IdLists measurements_;
    plr_truth truth_{};
    plr_message message_{};
};

/// Named quantities: commands to a sensor, inputs of a model.
class ValuesBuilder {
public:
    void clear() { entries_.clear(); }
    void add(std::string address, std::string name, std::string unit, const Eigen::MatrixXd& numbers,
             std::int64_t valid_from = std::numeric_limits<std::int64_t>::min(),
             std::int64_t valid_to = std::numeric_limits<std::int64_t>::max()) {
        entries_.push_back({std::move(address), std::move(name), std::move(unit), numbers, valid_from, valid_to});
    }
    const plr_message& message(std::int64_t time) {
        quantities_.clear();
        for (const Entry& e : entries_)
            quantities_.push_back({sizeof(plr_quantity), 0, e.address.c_str(), e.name.c_str(), e.unit.c_str(),
                                   const_view(e.numbers), e.valid_from, e.valid_to, nullptr});
        values_ = {sizeof(plr_values), static_cast<std::uint32_t>(quantities_.size()), quantities_.data()};
        message_ = detail::message_of(PLR_MESSAGE_VALUES, time);
        message_.body.values = &values_;
        return message_;
    }

private:
    struct Entry {
        std::string address, name, unit;
        Eigen::MatrixXd numbers;
        std::int64_t valid_from, valid_to;
    };
    std::deque<Entry> entries_;
    std::vector<plr_quantity> quantities_;
    plr_values values_{};
    plr_message message_{};
};

/// A result: rows of numbers, and scalars. `reduce` says how one run's becomes that of many (PLR_REDUCE_...).
class ResultBuilder {
public:
    explicit ResultBuilder(std::string name) : name_(std::move(name)) {}
    void column(std::string name, std::string unit, std::uint32_t reduce, double quantile = 0) {
        columns_.push_back({std::move(name), std::move(unit), reduce, quantile, {}, {}});
    }
    /// A text column: its numbers count into `texts`.
    void text_column(std::string name, std::uint32_t reduce, std::vector<std::string> texts) {
        columns_.push_back({std::move(name), "", reduce, 0, std::move(texts), {}});
    }
    void row(const std::vector<double>& values) { rows_.insert(rows_.end(), values.begin(), values.end()); }
    void scalar(std::string name, std::string unit, std::uint32_t reduce, double value, double quantile = 0,
                double weight = 1) {
        scalars_.push_back({std::move(name), std::move(unit), "", reduce, value, quantile, weight});
    }
    /// A scalar that is the mean over the rows of a reduced column (an RMSE: the mean over time of the RMS over runs).
    void scalar_of_column(std::string name, std::string unit, std::string column) {
        scalars_.push_back({std::move(name), std::move(unit), std::move(column), PLR_REDUCE_MEAN, 0, 0, 1});
    }
    const plr_message& message(std::int64_t time) {
        raw_columns_.clear();
        raw_scalars_.clear();
        for (Column& c : columns_) {
            c.pointers.clear();
            for (const auto& text : c.texts) c.pointers.push_back(text.c_str());
            raw_columns_.push_back({sizeof(plr_column), c.reduce, c.name.c_str(), c.unit.c_str(), c.quantile,
                                    c.pointers.empty() ? nullptr : c.pointers.data(),
                                    static_cast<std::uint32_t>(c.pointers.size()), 0});
        }
        for (const Scalar& s : scalars_)
            raw_scalars_.push_back({sizeof(plr_scalar), s.reduce, s.name.c_str(), s.unit.c_str(), s.value, s.quantile,
                                    s.column.empty() ? nullptr : s.column.c_str(), s.weight});
        const auto width = static_cast<std::int64_t>(columns_.size());
        const std::int64_t height = width == 0 ? 0 : static_cast<std::int64_t>(rows_.size()) / width;
        table_ = {sizeof(plr_table),
                  static_cast<std::uint32_t>(width),
                  name_.c_str(),
                  raw_columns_.data(),
                  const_view(rows_.data(), width, 1, height),
                  raw_scalars_.data(),
                  static_cast<std::uint32_t>(raw_scalars_.size()),
                  0};
        message_ = detail::message_of(PLR_MESSAGE_TABLE, time);
        message_.body.table = &table_;
        return message_;
    }

private:
    struct Column {
        std::string name, unit;
        std::uint32_t reduce;
        double quantile;
        std::vector<std::string> texts;
        std::vector<const char*> pointers;
    };
    struct Scalar {
        std::string name, unit, column;
        std::uint32_t reduce;
        double value, quantile, weight;
    };
    std::string name_;
    std::vector<Column> columns_;
    std::vector<Scalar> scalars_;
    std::vector<double> rows_;
    std::vector<plr_column> raw_columns_;
    std::vector<plr_scalar> raw_scalars_;
    plr_table table_{};
    plr_message message_{};
};

}  // namespace pelorus
