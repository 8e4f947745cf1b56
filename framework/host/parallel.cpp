#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "host/alternate_stack.hpp"
#include "host/breadcrumb.hpp"
#include "host/error.hpp"
#include "host/plugin_error.hpp"
#include "host/scratch.hpp"
#include "host/services.hpp"

namespace pelorus::host {

namespace {

constexpr std::size_t scratch_alignment = 64;
constexpr std::int64_t no_block = std::numeric_limits<std::int64_t>::max();

using Body = plr_status (*)(void* argument, std::int64_t first, std::int64_t last, plr_scratch* scratch,
                            plr_error* error);

/// The pools whose bodies the present thread is in, innermost first: a body that calls run() of one of them would wait for itself.
struct Within {
    const void* pool;
    const Within* outer;
};
thread_local const Within* within = nullptr;

bool is_within(const void* pool) noexcept {
    for (const Within* level = within; level != nullptr; level = level->outer)
        if (level->pool == pool) return true;
    return false;
}

/// One run(), shared by the threads that work on it.
class Job {
public:
    Job(std::int64_t count, std::int64_t block, Body body, void* argument, Within level)
        : count_(count), block_(block), body_(body), argument_(argument), level_(level) {}

    std::int64_t blocks() const noexcept { return count_ / block_ + (count_ % block_ != 0 ? 1 : 0); }

    /// Takes blocks until none is left. Blocks are handed out in ascending order; so when one fails, all before it are already
    /// taken and will be finished, and which one is the first to fail does not depend on the threads.
    void work(plr_scratch& scratch) noexcept {
        const BorrowedBreadcrumb crumb(callers_call_);
        const Within* const before = within;
        within = &level_;
        for (std::int64_t index = next_++; index < blocks() && index < first_failed_; index = next_++) {
            const std::int64_t first = index * block_;
            const std::int64_t last = first + std::min(block_, count_ - first);
            scratch.used = 0;
            plr_error error = empty_error();
            const plr_status status = guarded(error, [&] { return body_(argument_, first, last, &scratch, &error); });
            if (status != PLR_OK) keep(index, status, error);
        }
        within = before;
    }

    /// After all have worked: the first failing block's answer; without one, that of the first block with failed items.
    plr_status finish(plr_error& error) const noexcept {
        const Answer& answer = failed_.block != no_block ? failed_ : items_failed_;
        if (answer.block != no_block) error = answer.error;
        return answer.status;
    }

private:
    struct Answer {
        std::int64_t block = no_block;
        plr_status status = PLR_OK;
        plr_error error = empty_error();
    };

    void keep(std::int64_t block, plr_status status, const plr_error& error) noexcept {
        const std::lock_guard<std::mutex> lock(mutex_);
        Answer& answer = status < 0 ? failed_ : items_failed_;
        if (block >= answer.block) return;
        answer.block = block;
        answer.status = status;
        answer.error = error;
        if (status < 0) first_failed_ = block;
    }

    const std::int64_t count_, block_;
    const Body body_;
    void* const argument_;
    const Within level_;
    const CallMark* const callers_call_ = innermost_call;  // a job is made by the thread that runs it
    std::atomic<std::int64_t> next_{0};
    std::atomic<std::int64_t> first_failed_{no_block};
    std::mutex mutex_;
    Answer failed_, items_failed_;
};

struct Free {
    void operator()(unsigned char* memory) const noexcept { std::free(memory); }
};

}  // namespace

struct ThreadPool::Implementation {
    explicit Implementation(unsigned threads) : scratch(threads) {
        for (std::unique_ptr<unsigned char, Free>& memory : scratch) {
            memory.reset(static_cast<unsigned char*>(std::aligned_alloc(scratch_alignment, scratch_bytes)));
            if (memory == nullptr)
                throw Error(Exit::run_failed, "no memory for the scratch of " + std::to_string(threads) + " threads");
        }
        try {
            for (unsigned i = 1; i < threads; ++i) workers.emplace_back([this, i] { serve(scratch[i].get()); });
        } catch (const std::system_error& error) {
            stop();
            throw Error(Exit::run_failed,
                        "the system refuses " + std::to_string(threads) + " threads: " + error.what());
        }
    }

    ~Implementation() { stop(); }

    void stop() {
        {
            const std::lock_guard<std::mutex> lock(mutex);
            stopping = true;
        }
        wake.notify_all();
        for (std::thread& worker : workers) worker.join();
        workers.clear();
    }

    /// A worker's life.
    void serve(unsigned char* memory) {
        const AlternateStack stack;
        plr_scratch own{memory, scratch_bytes, 0};
        std::uint64_t last_seen = 0;
        std::unique_lock<std::mutex> lock(mutex);
        while (true) {
            wake.wait(lock, [&] { return stopping || (job != nullptr && job_number != last_seen); });
            if (stopping) return;
            last_seen = job_number;
            Job& joined = *job;
            ++working;
            lock.unlock();
            joined.work(own);
            lock.lock();
            if (--working == 0) idle.notify_all();
        }
    }

    void run(Job& next_job) {
        const std::lock_guard<std::mutex> one_at_a_time(run_mutex);
        plr_scratch own{scratch[0].get(), scratch_bytes, 0};
        if (workers.empty() || next_job.blocks() == 1) return next_job.work(own);
        {
            const std::lock_guard<std::mutex> lock(mutex);
            job = &next_job;
            ++job_number;
        }
        wake.notify_all();
        next_job.work(own);
        // All blocks are taken. Who has not woken up yet need not; who is at work is waited for.
        std::unique_lock<std::mutex> lock(mutex);
        job = nullptr;
        idle.wait(lock, [this] { return working == 0; });
    }

    static plr_status run(void* context, std::int64_t count, std::int64_t block, Body body, void* argument,
                          plr_error* error) noexcept {
        auto& self = *static_cast<Implementation*>(context);
        return answer(error, [&](plr_error& own) -> plr_status {
            if (count < 0 || block <= 0 || body == nullptr)
                return tell(&own, PLR_E_ARGUMENT, "parallel: expected count >= 0, block > 0 and a body");
            if (is_within(&self))
                return tell(&own, PLR_E_ARGUMENT, "parallel: run called from within a body of another run");
            if (count == 0) return PLR_OK;
            Job job(count, block, body, argument, {&self, within});
            self.run(job);
            return job.finish(own);
        });
    }

    std::vector<std::unique_ptr<unsigned char, Free>> scratch;  // [threads]; [0] is the caller's
    std::vector<std::thread> workers;
    std::mutex run_mutex;  // held for the whole of a run
    std::mutex mutex;      // of what follows
    std::condition_variable wake, idle;
    Job* job = nullptr;
    std::uint64_t job_number = 0;
    unsigned working = 0;
    bool stopping = false;
};

ThreadPool::ThreadPool(unsigned threads) {
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    implementation_ = std::make_unique<Implementation>(threads);
    service_ = {sizeof service_, threads, implementation_.get(), Implementation::run};
}

ThreadPool::~ThreadPool() = default;

}  // namespace pelorus::host
