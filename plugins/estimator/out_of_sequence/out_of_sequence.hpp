/// estimator.out_of_sequence: a filter that takes measurements late, exactly. See README.md.
///
/// The record of a track: [entries kept k, time of the state (s, <= 0), the wrapped filter's record at that time, entry, entry, ..].
/// An entry: [time (s, <= 0), sensor (-1: the start), measurement, its noise, the wrapped filter's record after it], ascending in
/// time. Times count from the newest time that the track has been predicted to.
#pragma once

#include <optional>

#include "../../common/filter_inside/filter_inside.hpp"

namespace out_of_sequence {

class OutOfSequence : public filter_inside::FilterInside<OutOfSequence> {
public:
    static void describe(pelorus::Describe<OutOfSequence>& plugin);
    void setup(const pelorus::Setup& setup);

    plr_status init(const plr_call& call, const plr_estimator_init& args) const;
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const;
    plr_status update(const plr_call& call, const plr_estimator_update& args) const;
    const void* extension(const char* id) const noexcept;
    void examine(const double* record) const;

private:
    /// Where the numbers of an entry are.
    struct Entry {
        double *time, *sensor, *measurement, *noise, *record;
    };
    Entry entry(double* record, std::int64_t index) const noexcept;
    std::int64_t entries(const double* record) const noexcept { return static_cast<std::int64_t>(record[0]); }
    double* current(double* record) const noexcept { return record + header; }

    bool goes_on(const plr_estimator_predict& args, std::int64_t item) const noexcept;
    plr_status go_on(const plr_call& call, const plr_estimator_predict& args) const;
    void go_to(const plr_call& one, double* record, double time) const;
    void shift(double* record, double by) const noexcept;
    std::int64_t last_up_to(double* record, double time) const noexcept;
    void insert(const plr_call& one, double* record, std::int32_t sensor, const double* measurement,
                const double* noise) const;
    void predict_one(const plr_call& one, const double* from, double dt, double* to) const;
    void update_one(const plr_call& one, const Entry& at) const;
    std::int64_t measured(std::int32_t sensor) const;
    static plr_status probabilities(const void* self, const plr_call* call, const plr_const_view* record,
                                    const plr_view* out) noexcept;

    static constexpr std::int64_t header = 2;

    int depth_ = 16;
    std::optional<double> maximum_lag_;  // s

    std::vector<std::int64_t> measured_;  // components of each sensor's measurements
    std::int64_t most_measured_ = 0, own_ = 0, entry_size_ = 0;
    const plr_estimator_modes* modes_of_filter_ = nullptr;
    plr_estimator_modes modes_{};
};

}  // namespace out_of_sequence
