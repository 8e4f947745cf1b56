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
// On one busy core threads overlap only where one is interrupted within a call: some slices of the scheduler's.
constexpr double quick_seconds = 0.03, long_seconds = 1.0;

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

/// Threads that begin each round together, until the last to come finds that the time is over.
class Rounds {
public:
    Rounds(std::size_t threads, double seconds)
        : threads_(threads),
          end_(std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                      std::chrono::duration<double>(seconds))) {}
    /// Waits for the others; false: there is no other round.
    bool begin() {
        const unsigned round = round_.load();
        if (arrived_.fetch_add(1) + 1 == threads_) {
            arrived_ = 0;
            // One round at least, however late the threads were started.
            is_over_ = is_stopped_ || (round > 0 && std::chrono::steady_clock::now() > end_);
            round_ = round + 1;
        } else {
            while (round_.load() == round) std::this_thread::yield();
        }
        return !is_over_;
    }
    /// The round is the last.
    void stop() { is_stopped_ = true; }

private:
    std::size_t threads_;
    std::chrono::steady_clock::time_point end_;
    std::atomic<std::size_t> arrived_{0};
    std::atomic<unsigned> round_{0};
    std::atomic<bool> is_over_{false}, is_stopped_{false};
};

/// All threads at once, each again and again through its calls.
void run_together(std::vector<Work>& all, double seconds) {
    Rounds rounds(all.size(), seconds);
    std::vector<std::thread> threads;
    for (Work& work : all)
        threads.emplace_back([&] {
            while (rounds.begin())
                for (std::size_t c = 0; c < work.calls.size() && work.difference.empty(); ++c) {
                    const Execution done = execute(*work.instance, work.calls[c], quickly());
                    std::string difference;
                    if (same_answer(work.calls[c], work.expected[c], done, difference)) continue;
                    work.difference = work.calls[c].function + ": " + difference;
                    rounds.stop();
                }
        });
    for (std::thread& thread : threads) thread.join();
}

void try_shared(Bench& bench, double seconds) {
    const auto instance = bench.make();
    std::vector<Work> all;
    for (unsigned t = 0; t < threads_at_once; ++t) all.push_back(work_of(bench, *instance, t));
    run_together(all, seconds);
    for (const Work& work : all)
        if (!work.difference.empty())
            FAIL("one instance called by " << threads_at_once
                                           << " threads (alone against together): " << work.difference
                                           << "; does a call write to a member, or to static memory?");
}

void try_apart(Bench& bench) {
    std::vector<std::unique_ptr<Instance>> instances;
    std::vector<Work> all;
    for (unsigned t = 0; t < threads_at_once; ++t) {
        instances.push_back(bench.make());
        all.push_back(work_of(bench, *instances.back(), t));
    }
    run_together(all, quick_seconds);
    for (const Work& work : all)
        if (!work.difference.empty())
            FAIL(threads_at_once << " threads with an instance each (alone against together): " << work.difference
                                 << "; does a call write to static memory?");
}

}  // namespace

PELORUS_CHECK(model, "threads-have-instances", 3,
              "Instances of several threads do not disturb one another: runs of a campaign share a process.",
              {"independent-of-earlier-calls"}) {
    try_apart(bench);
}

PELORUS_CHECK(model, "threads-share-an-instance", 3,
              "One instance answers several threads at once as it answers one: every call is [worker, concurrent].",
              {"threads-have-instances"}) {
    try_shared(bench, quick_seconds);
}

PELORUS_CHECK(model, "threads-share-an-instance-long", 5,
              "The same for a second: what goes wrong once in a hundred thousand calls goes wrong every night.",
              {"threads-share-an-instance"}) {
    try_shared(bench, long_seconds);
}

PELORUS_CHECK(
    model, "threads-race-free", 3,
    "ThreadSanitizer sees no race where threads have or share an instance; a race that does no harm today does with "
    "the next compiler.",
    {"threads-share-an-instance"}) {
    if (!race_detector::is_available()) skip("this runner is not built with ThreadSanitizer");
    std::ifstream file(bench.task().library, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (bytes.find("__tsan_") == std::string::npos) skip("this library is not built with ThreadSanitizer");
    const auto expect_none = [](const char* what) {
        const std::string race = race_detector::first_race();
        if (!race.empty()) FAIL("a race where " << threads_at_once << " threads " << what << ": " << race);
    };
    race_detector::forget();
    try_apart(bench);
    expect_none("have an instance each");
    race_detector::forget();
    try_shared(bench, quick_seconds);
    expect_none("share an instance");
}

}  // namespace pelorus::conformance
