/// What estimators share that hold another one: its record lies inside theirs, and what they do not change they hand on.
#pragma once

#include <pelorus/batch_model.hpp>

#include "../batches/batches.hpp"

namespace filter_inside {

/// Derived calls hold() in its setup, then fills what differs in `info`. Its `void examine(const double* record) const` throws
/// NumericError where a finite record is none of its own.
template <class Derived> class FilterInside : public pelorus::Estimator<Derived> {
public:
    static constexpr bool assignable = false;

    plr_status project(const plr_call& call, const plr_estimator_project& args) const {
        expect_record(args.record, args.measurement.count, "record");
        plr_estimator_project own = args;
        own.record = inside(args.record);
        return filter_.call(&plr_estimator::project, call, own);
    }
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const {
        return tell(call, args, &plr_estimator::summary);
    }
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const {
        return tell(call, args, &plr_estimator::moments);
    }

protected:
    /// The filter's record begins at `offset` of ours. The info is the filter's, but for what it says of assign and of dt < 0.
    void hold(const pelorus::EstimatorPart& filter, std::int64_t offset) {
        filter_ = filter;
        offset_ = offset;
        this->info = filter.info();
        this->info.struct_size = sizeof this->info;
        this->info.flags &= ~std::uint32_t{PLR_ESTIMATOR_ASSIGNABLE | PLR_ESTIMATOR_BACKWARD |
                                           PLR_ESTIMATOR_OUT_OF_SEQUENCE | PLR_FLAG_ANY_STRIDE};
    }
    const pelorus::EstimatorPart& filter() const noexcept { return filter_; }
    std::int64_t inside_size() const noexcept { return filter_.info().record_size; }
    /// The filter's record in each of ours.
    template <class View> View inside(const View& records) const noexcept {
        return batches::field(records, offset_, inside_size(), 1);
    }
    template <class View> void expect_record(const View& records, std::int64_t count, const char* what) const {
        batches::expect_packed(records, this->info.record_size, 1, count, what);
    }
    /// Throws NumericError unless it is a record that can be worked with.
    void expect_sound(const double* record) const {
        if (!batches::all_finite(record, this->info.record_size))
            throw pelorus::NumericError("the record is not finite");
        static_cast<const Derived&>(*this).examine(record);
    }
    /// Copies sound records; the others fail.
    plr_status copy(const plr_call& call, const plr_const_view& from, const plr_view& to) const {
        return pelorus::for_items(call, to.count, [&](std::int64_t i) {
            const double* const record = batches::at(from, i);
            expect_sound(record);
            if (record != batches::at(to, i)) std::copy_n(record, this->info.record_size, batches::at(to, i));
        });
    }
    /// The filter's own update of the records in args.out, which get the rest of args.record first.
    plr_status update_inside(const plr_call& call, const plr_estimator_update& args) const {
        expect_record(args.record, args.out.count, "record");
        expect_record(args.out, args.out.count, "out");
        if (const plr_status copied = copy(call, args.record, args.out); copied < 0) return copied;
        plr_estimator_update own = args;
        own.record = inside(pelorus::as_const(args.out));
        own.out = inside(args.out);
        return filter_.call(&plr_estimator::update, call, own);
    }

private:
    using Moments = plr_status (*plr_estimator::*)(const void*, const plr_call*, const plr_estimator_moments*);
    plr_status tell(const plr_call& call, const plr_estimator_moments& args, Moments function) const {
        expect_record(args.record, args.mean.count, "record");
        plr_estimator_moments own = args;
        own.record = inside(args.record);
        return filter_.call(function, call, own);
    }

    pelorus::EstimatorPart filter_;
    std::int64_t offset_ = 0;
};

}  // namespace filter_inside
