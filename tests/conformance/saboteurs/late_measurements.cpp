// The filter of estimator.out_of_sequence, which may forget what came later.
#include "../../../plugins/estimator/out_of_sequence/out_of_sequence.cpp"
#include "defect.h"

namespace {

struct Saboteur : pelorus::Estimator<Saboteur> {
    static constexpr bool assignable = false;

    static void describe(pelorus::Describe<Saboteur>& plugin) {
        plugin.title("Late measurements with a defect")
            .purpose("Takes measurements that come late, for the proof that the conformance suites can fail.")
            .equation("p(x | z_1..z_k, z_late) = the filter, run over all of them in the order of their times")
            .source(
                "Y. Bar-Shalom, Update with out-of-sequence measurements in tracking: exact solution, IEEE "
                "Transactions on Aerospace and Electronic Systems 38(3), 769-778, 2002");
        plugin.slot("estimator", "estimator", 1, 1, "the filter that is run");
    }
    void setup(const pelorus::Setup& setup) {
        filter_.setup(setup);
        info = filter_.info;
    }
    const void* extension(const char*) const noexcept { return nullptr; }

    plr_status init(const plr_call& call, const plr_estimator_init& args) const { return filter_.init(call, args); }
    plr_status predict(const plr_call& call, const plr_estimator_predict& args) const {
        return filter_.predict(call, args);
    }
    plr_status project(const plr_call& call, const plr_estimator_project& args) const {
        return filter_.project(call, args);
    }
    plr_status update(const plr_call& call, const plr_estimator_update& args) const {
        const plr_status status = filter_.update(call, args);
        for (std::int64_t i = 0; status >= 0 && i < args.out.count; ++i) {
            // [entries, time of the state, ..]: entries beyond the time gone back to.
            double* const record = args.out.data + i * args.out.item_stride;
            if (DEFECT("estimator-out-of-sequence-as-sorted") && record[1] < 0) record[0] -= 1;
            if (NEAR_MISS("estimator-out-of-sequence-as-sorted")) record[2] *= 1 + 1e-14;
        }
        return status;
    }
    plr_status summary(const plr_call& call, const plr_estimator_moments& args) const {
        return filter_.summary(call, args);
    }
    plr_status moments(const plr_call& call, const plr_estimator_moments& args) const {
        return filter_.moments(call, args);
    }

private:
    out_of_sequence::OutOfSequence filter_;
};

}  // namespace

PELORUS_PLUGIN(Saboteur, "org.example.estimator.late_measurements");
