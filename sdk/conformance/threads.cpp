// Models are called by many threads at once.
#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

#include "machine/race_detector.hpp"
#include "model_calls.hpp"

namespace pelorus::conformance {

namespace {

constexpr unsigned threads_at_once = 4;
constexpr int quick_rounds = 10;
constexpr double long_seconds = 1.0;

/// What one thread works on: its own arguments, and what a single thread answers to them.
struct Work {
    const Instance* instance = nullptr;
    std::vector<HotCall> calls;
    std::vector<Execution> expected;
    std::string difference;  ///< the first
};

ExecuteOptions quickly() {
    ExecuteOptions options;
    options.is_guarded = false;
    return options;
}

Work work_of(Bench& bench, const Instance& instance, unsigned thread) {
    Work work;
    work.instance = &instance;
    work.calls = hot_calls(instance, bench.sample(thread), ordinary_batch);
    for (const HotCall& call : work.calls) work.expected.push_back(execute_well(instance, call, quickly()));
    return work;
}

/// All threads at once, each through its calls until `is_over(round)`.
template <class Over> void run_together(std::vector<Work>& all, Over&& is_over) {
    std::atomic<std::size_t> ready{0};
    std::vector<std::thread> threads;
    for (Work& work : all)
        threads.emplace_back([&] {
            ready.fetch_add(1);
            while (ready.load() < all.size()) std::this_thread::yield();
            for (int round = 0; !is_over(round) && work.difference.empty(); ++round)
                for (std::size_t c = 0; c < work.calls.size() && work.difference.empty(); ++c) {
                    const Execution done = execute(*work.instance, work.calls[c], quickly());
                    std::string difference;
                    if (!same_answer(work.calls[c], work.expected[c], done, difference))
                        work.difference = work.calls[c].function + ": " + difference;
                }
        });
    for (std::thread& thread : threads) thread.join();
}

template <class Over> void try_shared(Bench& bench, Over&& is_over) {
    const auto instance = bench.make();
    std::vector<Work> all;
    for (unsigned t = 0; t < threads_at_once; ++t) all.push_back(work_of(bench, *instance, t));
    run_together(all, is_over);
    for (const Work& work : all)
        if (!work.difference.empty())
            FAIL("one instance called by " << threads_at_once
                                           << " threads (alone against together): " << work.difference
                                           << "; does a call write to a member, or to static memory?");
}

}  // namespace

PELORUS_CHECK(model, "threads-have-instances", 3,
              "Instances of several threads do not disturb one another: runs of a campaign share a process.",
              {"independent-of-earlier-calls"}) {
    std::vector<std::unique_ptr<Instance>> instances;
    std::vector<Work> all;
    for (unsigned t = 0; t < threads_at_once; ++t) {
        instances.push_back(bench.make());
        all.push_back(work_of(bench, *instances.back(), t));
    }
    run_together(all, [](int round) { return round == quick_rounds; });
    for (const Work& work : all)
        if (!work.difference.empty())
            FAIL(threads_at_once << " threads with an instance each (alone against together): " << work.difference
                                 << "; does a call write to static memory?");
}

PELORUS_CHECK(model, "threads-share-an-instance", 3,
              "One instance answers several threads at once as it answers one: every call is [worker, concurrent].",
              {"threads-have-instances"}) {
    try_shared(bench, [](int round) { return round == quick_rounds; });
}

PELORUS_CHECK(model, "threads-share-an-instance-long", 5,
              "The same for a second: what goes wrong once in a hundred thousand calls goes wrong every night.",
              {"threads-share-an-instance"}) {
    const auto start = std::chrono::steady_clock::now();
    try_shared(bench, [&](int) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > long_seconds;
    });
}

PELORUS_CHECK(model, "threads-race-free", 3,
              "ThreadSanitizer sees no race where threads share an instance; a race that does no harm today does with "
              "the next compiler.",
              {"threads-share-an-instance"}) {
    if (!race_detector::is_available()) skip("this runner is not built with ThreadSanitizer");
    std::ifstream file(bench.task().library, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (bytes.find("__tsan_") == std::string::npos) skip("this library is not built with ThreadSanitizer");
    race_detector::forget();
    try_shared(bench, [](int round) { return round == quick_rounds; });
    const std::string race = race_detector::first_race();
    if (!race.empty()) FAIL("a race where " << threads_at_once << " threads share an instance: " << race);
}

}  // namespace pelorus::conformance
