#include "campaign/workers.hpp"

#include <system_error>
#include <utility>

#include "host/error.hpp"

namespace pelorus::campaign {

Workers::Workers(const PipelineContext& context, const Plan& plan, unsigned threads)
    : context_(context), plan_(plan), blocks_(plan.runs) {
    try {
        for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
    } catch (const std::system_error& problem) {
        stop();
        throw Error(Exit::run_failed, "the system refuses " + std::to_string(threads) + " threads: " + problem.what());
    }
}

Workers::~Workers() { stop(); }

void Workers::stop() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stopping_ = true;
    }
    given_.notify_all();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
}

void Workers::give(const Unit& unit) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        waiting_.push_back(unit);
        ++under_way_;
    }
    given_.notify_one();
}

std::vector<Computed> Workers::take(std::chrono::milliseconds wait) {
    std::unique_lock<std::mutex> lock(mutex_);
    done_.wait_for(lock, wait, [this] { return !computed_.empty(); });
    under_way_ -= computed_.size();
    return std::exchange(computed_, {});
}

std::size_t Workers::under_way() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return under_way_;
}

std::size_t Workers::wanted() const {
    const std::size_t enough = 2 * threads_.size();
    const std::size_t there = under_way();
    return there < enough ? enough - there : 0;
}

void Workers::work() {
    std::optional<CellPipeline> pipeline;
    while (true) {
        Unit unit;
        {
            std::unique_lock<std::mutex> lock(mutex_);
            given_.wait(lock, [this] { return stopping_ || !waiting_.empty(); });
            if (stopping_) return;
            unit = waiting_.front();
            waiting_.pop_front();
        }
        Computed computed = compute(unit, pipeline);
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            computed_.push_back(std::move(computed));
        }
        done_.notify_one();
    }
}

Computed Workers::compute(const Unit& unit, std::optional<CellPipeline>& pipeline) const {
    Computed computed;
    computed.unit = unit;
    if (!pipeline || pipeline->cell() != unit.cell) {
        pipeline.reset();
        try {
            pipeline.emplace(context_, plan_.cells[unit.cell]);
        } catch (const std::exception& problem) {
            computed.failure = Failure{unit.cell, blocks_.first_run(unit.block), problem.what()};
            return computed;
        }
    }
    for (std::uint64_t number = blocks_.first_run(unit.block); number < blocks_.last_run(unit.block); ++number)
        if (!run(number, *pipeline, computed)) return computed;
    computed.is_complete = true;
    computed.timings = pipeline->take_timings();
    return computed;
}

/// Whether the block goes on.
bool Workers::run(std::uint64_t number, CellPipeline& pipeline, Computed& computed) const {
    if (context_.stop != nullptr && context_.stop->load(std::memory_order_relaxed)) return false;
    try {
        pipeline.run(number, computed.totals);
        return true;
    } catch (const Stopped&) {
        return false;
    } catch (const std::exception& problem) {
        if (plan_.goes_on) {
            computed.totals.add_failed({number, problem.what()});
            return true;
        }
        computed.failure = Failure{computed.unit.cell, number, problem.what()};
        return false;
    }
}

}  // namespace pelorus::campaign
