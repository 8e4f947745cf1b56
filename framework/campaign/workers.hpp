/// Threads that compute blocks of runs.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "campaign/cell_pipeline.hpp"
#include "campaign/cell_totals.hpp"
#include "campaign/cells.hpp"

namespace pelorus::campaign {

/// A block of a cell's runs.
struct Unit {
    std::size_t cell = 0;
    std::uint64_t block = 0;
};

/// A run that failed and was not to.
struct Failure {
    std::size_t cell = 0;
    std::uint64_t run = 0;
    std::string message;
};

/// What has become of a block.
struct Computed {
    Unit unit;
    bool is_complete = false;  ///< false: stopped, or a run failed
    Totals totals;
    std::optional<Failure> failure;
    NodeTimings timings;
};

/// Each thread keeps the pipeline of the cell that it was last at work on.
class Workers {
public:
    /// `context` and `plan` must outlive this object. Throws Error: the system refuses so many threads.
    Workers(const PipelineContext& context, const Plan& plan, unsigned threads);
    /// Waits for the blocks under way; those that no thread has taken are forgotten.
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    void give(const Unit& unit);
    /// What is done, in the order in which it came to be; waits a while for the first.
    std::vector<Computed> take(std::chrono::milliseconds wait);
    /// Blocks that were given and not taken yet, done or not.
    std::size_t under_way() const;
    /// How many more to give, so that no thread waits for work.
    std::size_t wanted() const;

private:
    void work();
    Computed compute(const Unit& unit, std::optional<CellPipeline>& pipeline) const;
    bool run(std::uint64_t number, CellPipeline& pipeline, Computed& computed) const;
    void stop();

    const PipelineContext& context_;
    const Plan& plan_;
    const Blocks blocks_;
    mutable std::mutex mutex_;
    std::condition_variable given_, done_;
    std::deque<Unit> waiting_;
    std::vector<Computed> computed_;
    std::size_t under_way_ = 0;
    bool stopping_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace pelorus::campaign
