#include "out_of_sequence.hpp"

#include <cmath>
#include <cstring>

#include <pelorus/abi/record.h>

namespace out_of_sequence {

using batches::at;
using batches::expect_packed;
using pelorus::PartError;

namespace {

/// Half a nanosecond, s: times of Pelorus are whole nanoseconds, so that nearer ones are the same.
constexpr double same_time = 0.5e-9;

/// Throws, with the code of the item, where a call for a single item failed.
void require_one(plr_status status, const plr_call& one) {
    if (status == PLR_ITEMS_FAILED) throw pelorus::PartFailed(one.item_status[0]);
    pelorus::require(status);
}

}  // namespace

void OutOfSequence::describe(pelorus::Describe<OutOfSequence>& plugin) {
    plugin.title("Out-of-sequence measurements, exactly")
        .purpose(
            "Lets any filter take measurements that come late: it remembers the last measurements and the filter's "
            "record after each, puts a late one in where it belongs and filters again what came later.")
        .equation("p(x | z_1..z_k, z_late) = the filter, run over all of them in the order of their times")
        .source(
            "Y. Bar-Shalom, Update with out-of-sequence measurements in tracking: exact solution, IEEE Transactions on "
            "Aerospace and Electronic Systems 38(3), 769-778, 2002 (the problem); Y. Bar-Shalom, P. K. Willett, X. "
            "Tian, Tracking and Data Fusion: A Handbook of Algorithms, YBS 2011 (reprocessing, by which "
            "approximate solutions are judged)");
    plugin.slot("estimator", "estimator", 1, 1, "the filter that is run; one that draws no random numbers");
    plugin.parameter("depth", &OutOfSequence::depth_)
        .initially("16")
        .min(1)
        .max(1024)
        .doc("how many measurements of a track are remembered; a late one must be newer than the oldest of them");
    plugin.parameter("maximum_lag", &OutOfSequence::maximum_lag_)
        .unit("s")
        .above(0.0)
        .doc("a measurement is not used when it is later than this; not given: `depth` alone bounds");
}

void OutOfSequence::setup(const pelorus::Setup& setup) {
    hold(setup.part<pelorus::EstimatorPart>("estimator"), header);
    const plr_estimator_info& held = filter().info();
    if ((held.flags & PLR_FLAG_USES_KEYS) != 0)
        throw PartError("estimator", filter().id() +
                                         " draws random numbers; filtered again, it would draw others, and no step "
                                         "could be repeated exactly");
    if ((held.flags & PLR_ESTIMATOR_USES_EXTENT) != 0)
        throw PartError(
            "estimator",
            filter().id() + " needs the extent of each step, which is not remembered; expected one without");
    own_ = held.record_size;
    const char* place = reinterpret_cast<const char*>(held.sensors);
    for (std::uint32_t s = 0; s < held.sensor_count; ++s) {
        const auto& part = *reinterpret_cast<const plr_part*>(place);
        measured_.push_back(pelorus::SensorPart(part).info().measurement->size);
        most_measured_ = std::max(most_measured_, measured_.back());
        place += part.struct_size;
    }
    entry_size_ = 2 + most_measured_ + most_measured_ * most_measured_ + own_;
    modes_of_filter_ = filter().extension<plr_estimator_modes>(PLR_ESTIMATOR_MODES);
    if (modes_of_filter_ != nullptr)
        modes_ = {sizeof modes_, modes_of_filter_->mode_count, modes_of_filter_->names, &OutOfSequence::probabilities};

    info.flags |= PLR_ESTIMATOR_BACKWARD | PLR_ESTIMATOR_OUT_OF_SEQUENCE;
    info.record_size = header + own_ + (depth_ + 1) * entry_size_;
    info.record_version = plr_mix_version(1, held.record_version);
}

const void* OutOfSequence::extension(const char* id) const noexcept {
    return modes_of_filter_ != nullptr && std::strcmp(id, PLR_ESTIMATOR_MODES) == 0 ? &modes_ : nullptr;
}

plr_status OutOfSequence::probabilities(const void* self, const plr_call* call, const plr_const_view* record,
                                        const plr_view* out) noexcept {
    const auto& own = *static_cast<const OutOfSequence*>(self);
    return pelorus::guarded(call->error, [&] {
        own.expect_record(*record, out->count, "record");
        const plr_const_view records = own.inside(*record);
        return own.modes_of_filter_->probabilities(own.filter().self(), call, &records, out);
    });
}

OutOfSequence::Entry OutOfSequence::entry(double* record, std::int64_t index) const noexcept {
    double* const first = record + header + own_ + index * entry_size_;
    double* const noise = first + 2 + most_measured_;
    return {first, first + 1, first + 2, noise, noise + most_measured_ * most_measured_};
}

std::int64_t OutOfSequence::measured(std::int32_t sensor) const {
    if (sensor < 0 || static_cast<std::size_t>(sensor) >= measured_.size())
        throw pelorus::ArgumentError("sensor: is " + std::to_string(sensor) + ", expected 0 to " +
                                     std::to_string(measured_.size() - 1));
    return measured_[static_cast<std::size_t>(sensor)];
}

/// A record comes from a file, too.
void OutOfSequence::examine(const double* record) const {
    const double kept = record[0];
    bool is_own = kept >= 1 && kept <= depth_ + 1 && kept == std::floor(kept) && record[1] <= 0;
    const double* at_entry = record + header + own_;
    for (std::int64_t k = 0; is_own && k < entries(record); ++k, at_entry += entry_size_) {
        const double sensor = at_entry[1];
        is_own = at_entry[0] <= 0 && sensor >= -1 && sensor < static_cast<double>(measured_.size()) &&
                 sensor == std::floor(sensor) && (k == 0 || (sensor >= 0 && at_entry[0] >= *(at_entry - entry_size_)));
    }
    if (!is_own || record[1] < record[header + own_] - same_time)
        throw pelorus::NumericError("the record is not one of this estimator");
}

/// The start is the first entry: no measurement, but a record to go on from.
plr_status OutOfSequence::init(const plr_call& call, const plr_estimator_init& args) const {
    const std::int64_t count = args.record.count;
    expect_record(args.record, count, "record");
    plr_estimator_init start = args;
    start.record = inside(args.record);
    const plr_status status = filter().call(&plr_estimator::init, call, start);
    if (status < 0) return status;
    return batches::for_good_items(call, count, [&](std::int64_t i) {
        double* const record = at(args.record, i);
        record[0] = 1;
        record[1] = 0;
        std::fill(record + header + own_, record + info.record_size, 0.0);
        const Entry first = entry(record, 0);
        *first.sensor = -1;
        std::copy_n(current(record), own_, first.record);
    });
}

void OutOfSequence::shift(double* record, double by) const noexcept {
    for (std::int64_t k = 0; k < entries(record); ++k) *entry(record, k).time -= by;
}

/// Whether an item's prediction leads from its newest time to a newer one, as if nothing ever came late.
bool OutOfSequence::goes_on(const plr_estimator_predict& args, std::int64_t item) const noexcept {
    return at(args.record, item)[1] == 0.0 && at(args.dt, item)[0] > 0.0;
}

plr_status OutOfSequence::predict(const plr_call& call, const plr_estimator_predict& args) const {
    const std::int64_t count = args.out.count;
    pelorus::expect(args.dt, 1, 1, count, "dt");
    expect_record(args.record, count, "record");
    expect_record(args.out, count, "out");
    plr_status result = PLR_OK;
    for (std::int64_t first = 0, end = 0; first < count; first = end) {
        end = first + 1;
        while (goes_on(args, first) && end < count && goes_on(args, end)) ++end;
        plr_estimator_predict run = args;
        run.dt = pelorus::slice(args.dt, first, end - first);
        run.extent = pelorus::absent_view();
        run.record = pelorus::slice(args.record, first, end - first);
        run.out = pelorus::slice(args.out, first, end - first);
        const plr_call here = pelorus::slice(call, first);
        plr_status status = PLR_OK;
        if (goes_on(args, first)) {
            status = go_on(here, run);
        } else {
            status = copy(here, run.record, run.out);
            if (status == PLR_OK)
                status = pelorus::for_items(here, 1, [&](std::int64_t) {
                    double* const record = run.out.data;
                    if (const double dt = run.dt.data[0]; dt != 0.0) go_to(here, record, record[1] + dt);
                });
        }
        if (status < 0) return status;
        if (status != PLR_OK) result = status;
    }
    return result;
}

plr_status OutOfSequence::go_on(const plr_call& call, const plr_estimator_predict& args) const {
    if (const plr_status copied = copy(call, args.record, args.out); copied < 0) return copied;
    plr_estimator_predict step = args;
    step.record = inside(pelorus::as_const(args.out));
    step.out = inside(args.out);
    const plr_status status = filter().call(&plr_estimator::predict, call, step);
    if (status < 0) return status;
    return batches::for_good_items(call, args.out.count,
                                   [&](std::int64_t i) { shift(at(args.out, i), at(args.dt, i)[0]); });
}

/// Index of the last entry up to that time, or -1.
std::int64_t OutOfSequence::last_up_to(double* record, double time) const noexcept {
    std::int64_t last = entries(record) - 1;
    while (last >= 0 && *entry(record, last).time > time + same_time) --last;
    return last;
}

/// The state at that time, from the last measurement before it.
void OutOfSequence::go_to(const plr_call& one, double* record, double time) const {
    if (!std::isfinite(time)) throw pelorus::NumericError("dt is not finite");
    if (std::fabs(time) <= same_time) time = 0;
    const auto late = [&](const std::string& expected) {
        throw pelorus::NumericError(std::to_string(-time) + " s before the newest time of the track, expected " +
                                    expected);
    };
    if (maximum_lag_ && -time > *maximum_lag_ + same_time)
        late("at most " + std::to_string(*maximum_lag_) + " s (maximum_lag)");
    const std::int64_t last = last_up_to(record, time);
    if (last < 0)
        late("at most " + std::to_string(-*entry(record, 0).time) + " s: what was earlier is forgotten (depth)");
    const Entry from = entry(record, last);
    if (const double dt = time - *from.time; std::fabs(dt) > same_time)
        predict_one(one, from.record, dt, current(record));
    else
        std::copy_n(from.record, own_, current(record));
    record[1] = std::min(time, 0.0);
    if (time > 0) shift(record, time);
}

void OutOfSequence::predict_one(const plr_call& one, const double* from, double dt, double* to) const {
    auto step = pelorus::arguments<plr_estimator_predict>();
    step.dt = pelorus::const_view(&dt, 1, 1, 1);
    step.record = pelorus::const_view(from, own_, 1, 1);
    step.out = pelorus::view(to, own_, 1, 1);
    require_one(filter().call(&plr_estimator::predict, one, step), one);
}

/// The measurement of an entry, used by its record.
void OutOfSequence::update_one(const plr_call& one, const Entry& here) const {
    auto step = pelorus::arguments<plr_estimator_update>();
    step.sensor = static_cast<std::int32_t>(*here.sensor);
    const std::int64_t m = measured(step.sensor);
    step.record = pelorus::const_view(here.record, own_, 1, 1);
    step.measurement = pelorus::const_view(here.measurement, m, 1, 1);
    step.noise = pelorus::const_view(here.noise, m, m, 1);
    step.out = pelorus::view(here.record, own_, 1, 1);
    require_one(filter().call(&plr_estimator::update, one, step), one);
}

plr_status OutOfSequence::update(const plr_call& call, const plr_estimator_update& args) const {
    const std::int64_t count = args.out.count, m = measured(args.sensor);
    expect_packed(args.measurement, m, 1, count, "measurement");
    expect_packed(args.noise, m, m, count, "noise");
    const plr_status status = update_inside(call, args);
    if (status < 0) return status;
    return batches::for_good_items(call, count, [&](std::int64_t i) {
        insert(pelorus::slice(call, i), at(args.out, i), args.sensor, at(args.measurement, i), at(args.noise, i));
    });
}

/// Keeps the measurement that has led to the state, among the others by its time, and filters again what came later.
void OutOfSequence::insert(const plr_call& one, double* record, std::int32_t sensor, const double* measurement,
                           const double* noise) const {
    const std::int64_t m = measured(sensor);
    if (!batches::all_finite(measurement, m) || !batches::all_finite(noise, m * m))
        throw pelorus::NumericError("the measurement or its noise is not finite, so that it cannot be kept");
    std::int64_t place = last_up_to(record, record[1]) + 1, kept = entries(record);
    if (kept == depth_ + 1) {  // the oldest is forgotten; what it led to is where the next one starts from
        std::copy(entry(record, 1).time, entry(record, kept).time, entry(record, 0).time);
        --kept;
        --place;
    }
    std::copy_backward(entry(record, place).time, entry(record, kept).time, entry(record, kept + 1).time);
    record[0] = static_cast<double>(kept + 1);
    const Entry here = entry(record, place);
    *here.time = record[1];
    *here.sensor = sensor;
    std::copy_n(measurement, m, here.measurement);
    std::copy_n(noise, m * m, here.noise);
    std::copy_n(current(record), own_, here.record);
    for (std::int64_t k = place + 1; k <= kept; ++k) {
        const Entry before = entry(record, k - 1), again = entry(record, k);
        plr_call then = one;
        then.time += std::llround((*again.time - record[1]) * 1e9);
        if (const double dt = *again.time - *before.time; dt > same_time)
            predict_one(then, before.record, dt, again.record);
        else
            std::copy_n(before.record, own_, again.record);
        update_one(then, again);
    }
}

}  // namespace out_of_sequence
