// What a hot call must not ask of the operating system. The first call of an instance is watched like any other: it may come in the
// middle of a run.
#include "model_calls.hpp"

namespace pelorus::conformance {

namespace {

void expect_none(Bench& bench, watch::Concern concern, const char* instead) {
    if (!watch::is_available()) skip("this runner is built with sanitizers, which stand where the watch would");
    for_calls(bench, [&](const Instance& instance, const HotCall& call) {
        ExecuteOptions options;
        options.watch = static_cast<unsigned>(concern);
        const Execution done = execute_well(instance, call, options);
        if (done.status != PLR_OK) return;  // an item was refused: an exception allocates
        if (done.offence.function != nullptr)
            FAIL(call.function << " calls " << done.offence.function << " ("
                               << (done.offence.count == 1 ? "once" : std::to_string(done.offence.count) + " times")
                               << " for " << call.count << " items)"
                               << (done.offence.place.empty() ? "" : " at " + done.offence.place) << "; " << instead);
    });
}

}  // namespace

PELORUS_CHECK(model, "hot-calls-allocate-nothing", 2,
              "A hot call does not allocate; the allocator's time has no bound, and its locks are shared.",
              {"calls-succeed"}) {
    expect_none(bench, watch::Concern::memory, "scratch memory is in plr_call.scratch");
}

PELORUS_CHECK(model, "hot-calls-take-no-locks", 2,
              "A hot call neither locks nor sleeps; one that waits for another thread holds all tracks up.",
              {"calls-succeed"}) {
    expect_none(bench, watch::Concern::locks, "an instance that does not change needs none");
}

PELORUS_CHECK(model, "hot-calls-read-no-clock", 2,
              "A hot call reads no clock; time is plr_call.time and dt, or a recording cannot be played again.",
              {"calls-succeed"}) {
    expect_none(bench, watch::Concern::clocks, "the time is in plr_call.time");
}

PELORUS_CHECK(model, "hot-calls-draw-no-chance", 2,
              "A hot call draws random numbers from its keys alone; rand() and its kin differ with the order of calls.",
              {"calls-succeed"}) {
    expect_none(bench, watch::Concern::chance, "random numbers come from plr_call.keys and the host's service");
}

PELORUS_CHECK(model, "hot-calls-touch-no-files", 2,
              "A hot call neither reads nor writes files, standard output included; a disk may take seconds.",
              {"calls-succeed"}) {
    expect_none(bench, watch::Concern::files, "lines for the log go to plr_call.log");
}

}  // namespace pelorus::conformance
