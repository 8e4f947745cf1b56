#include "campaign/engine.hpp"

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <thread>
#include <tuple>
#include <utility>

#include "campaign/finished_cell.hpp"
#include "campaign/rank_messages.hpp"
#include "host/error.hpp"

namespace pelorus::campaign {

namespace {

using Clock = std::chrono::steady_clock;

/// Cells in order, and in them the blocks that are not kept yet.
class Dispatcher {
public:
    Dispatcher(const Plan& plan, const std::vector<std::size_t>& cells, Store& store)
        : plan_(plan), blocks_(plan.runs), store_(store) {
        advance_.cells = cells.size();
        advance_.runs = cells.size() * plan.runs;
        for (const std::size_t cell : cells)  // what is kept is counted before anything is computed
            if (store.is_begun(cell))
                open(cell);
            else
                left_.push_back(cell);
    }

    std::optional<Unit> next() {
        while (waiting_.empty() && !left_.empty()) {
            open(left_.front());
            left_.pop_front();
        }
        if (waiting_.empty()) return std::nullopt;
        const Unit unit = waiting_.front();
        waiting_.pop_front();
        return unit;
    }

    /// A block that was computed just now.
    void add(const Unit& unit, Totals totals) {
        store_.append(unit.cell, unit.block, totals);
        count(totals);
        put(unit, std::move(totals));
    }

    bool is_done() const { return advance_.cells_done == advance_.cells; }
    const Advance& advance() const { return advance_; }

private:
    void open(std::size_t cell) {
        if (store_.has_cell(cell)) {
            ++advance_.cells_done;
            advance_.runs_done += plan_.runs;
            advance_.runs_kept += plan_.runs;
            advance_.runs_failed += store_.cell(cell).at("cell").value("failed", std::uint64_t{0});
            return;
        }
        open_.emplace(cell, CellTotals(blocks_));
        std::vector<bool> there(static_cast<std::size_t>(blocks_.count()), false);
        for (auto& [block, totals] : store_.blocks(cell)) {
            if (block >= blocks_.count() || there[static_cast<std::size_t>(block)]) continue;
            there[static_cast<std::size_t>(block)] = true;
            advance_.runs_kept += totals.runs();
            count(totals);
            put({cell, block}, std::move(totals));
        }
        for (std::uint64_t block = 0; block < blocks_.count(); ++block)
            if (!there[static_cast<std::size_t>(block)]) waiting_.push_back({cell, block});
    }

    void count(const Totals& totals) {
        advance_.runs_done += totals.runs();
        advance_.runs_failed += totals.failed().size();
    }

    void put(const Unit& unit, Totals totals) {
        const auto found = open_.find(unit.cell);
        if (found == open_.end()) return;
        const Cell& cell = plan_.cells[unit.cell];
        try {
            found->second.add(unit.block, std::move(totals));
            if (!found->second.is_complete()) return;
            report::Cell entry;
            entry.variant = cell.variant;
            entry.sweep = cell.shown_sweep;
            store_.finish(unit.cell, finished_cell(found->second, std::move(entry)));
        } catch (const Error&) {
            throw;
        } catch (const std::exception& problem) {
            throw Error(Exit::run_failed, cell_text(cell) + ": " + problem.what());
        }
        open_.erase(found);
        ++advance_.cells_done;
    }

    const Plan& plan_;
    const Blocks blocks_;
    Store& store_;
    std::deque<std::size_t> left_;
    std::deque<Unit> waiting_;
    std::map<std::size_t, CellTotals> open_;
    Advance advance_;
};

/// Rank 0 at work.
class Master {
public:
    Master(const PipelineContext& context, const Plan& plan, const EngineOptions& options, Store& store, Ranks* ranks)
        : context_(context),
          options_(options),
          ranks_(ranks),
          dispatcher_(plan, options.cells, store),
          workers_(context, plan, options.threads) {}

    EngineResult run() {
        feed();
        while (!is_over()) {
            for (Computed& computed : workers_.take(std::chrono::milliseconds(ranks_ != nullptr ? 2 : 50)))
                take(std::move(computed));
            hear_ranks();
            feed();
            tell_progress(false);
        }
        if (ranks_ != nullptr)
            for (int rank = 1; rank < ranks_->size(); ++rank) ranks_->send(rank, order_bytes({{}, true}));
        tell_progress(true);
        result_.completed = dispatcher_.is_done();
        result_.advance = dispatcher_.advance();
        return std::move(result_);
    }

private:
    bool is_stopped() const {
        return result_.failure || (context_.stop != nullptr && context_.stop->load(std::memory_order_relaxed));
    }

    /// All is done, or nothing more is to be begun and nothing is under way.
    bool is_over() {
        const bool is_idle = workers_.under_way() == 0 && at_ranks_ == 0;
        return is_idle && (is_stopped() || (dispatcher_.is_done() && greeted_ + 1 >= size()));
    }
    int size() const { return ranks_ == nullptr ? 1 : ranks_->size(); }

    void feed() {
        for (std::size_t wanted = workers_.wanted(); wanted > 0 && !is_stopped(); --wanted) {
            const std::optional<Unit> unit = dispatcher_.next();
            if (!unit) return;
            workers_.give(*unit);
        }
    }

    void take(Computed computed) {
        add_timings(result_.timings, computed.timings);
        if (computed.is_complete) dispatcher_.add(computed.unit, std::move(computed.totals));
        if (!computed.failure) return;
        const auto place = [](const Failure& failure) { return std::tie(failure.cell, failure.run); };
        if (!result_.failure || place(*computed.failure) < place(*result_.failure))
            result_.failure = std::move(computed.failure);
    }

    void hear_ranks() {
        if (ranks_ == nullptr) return;
        while (auto message = ranks_->poll()) {
            RankReport report = report_from(message->second);
            if (!report.identity.empty()) {
                ++greeted_;
                if (report.identity != options_.identity)
                    throw Error(Exit::run_failed, "rank " + std::to_string(message->first) +
                                                      " computes something else: all ranks must have the same config, "
                                                      "plugins and Pelorus");
            }
            at_ranks_ -= report.computed.size();
            for (Computed& computed : report.computed) take(std::move(computed));
            RankOrder order;
            for (std::uint32_t wanted = report.wanted; wanted > 0 && !is_stopped(); --wanted) {
                const std::optional<Unit> unit = dispatcher_.next();
                if (!unit) break;
                order.units.push_back(*unit);
            }
            at_ranks_ += order.units.size();
            if (!order.units.empty()) ranks_->send(message->first, order_bytes(order));
        }
    }

    void tell_progress(bool at_end) {
        const Clock::time_point now = Clock::now();
        if (!options_.on_progress || (!at_end && now - told_ < std::chrono::milliseconds(100))) return;
        told_ = now;
        options_.on_progress(dispatcher_.advance());
    }

    const PipelineContext& context_;
    const EngineOptions& options_;
    Ranks* const ranks_;
    Dispatcher dispatcher_;
    Workers workers_;
    EngineResult result_;
    std::size_t at_ranks_ = 0;  // blocks that other ranks are at work on
    int greeted_ = 0;           // ranks that have come
    Clock::time_point told_;
};

}  // namespace

EngineResult compute(const PipelineContext& context, const Plan& plan, const EngineOptions& options, Store& store,
                     Ranks* ranks) {
    return Master(context, plan, options, store, ranks).run();
}

void serve(const PipelineContext& context, const Plan& plan, const EngineOptions& options, Ranks& ranks) {
    Workers workers(context, plan, options.threads);
    RankReport report;
    report.identity = options.identity;
    report.wanted = static_cast<std::uint32_t>(workers.wanted());
    ranks.send(0, report_bytes(report));
    while (true) {
        while (auto message = ranks.poll()) {
            const RankOrder order = order_from(message->second);
            if (order.is_last) return;
            for (const Unit& unit : order.units) workers.give(unit);
        }
        RankReport next;
        next.computed = workers.take(std::chrono::milliseconds(2));
        if (next.computed.empty()) continue;
        next.wanted = static_cast<std::uint32_t>(workers.wanted());
        ranks.send(0, report_bytes(next));
    }
}

}  // namespace pelorus::campaign
