/// What the spies (tests/fixtures/spy) wrote down, and what the headers of the ABI promise of it. Every check says which promise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pelorus::test {

class SpyLog {
public:
    using Call = nlohmann::json;

    explicit SpyLog(const std::filesystem::path& file);

    /// In the order in which they began.
    const std::vector<Call>& calls() const noexcept { return calls_; }
    std::vector<Call> where(const std::function<bool(const Call&)>& wanted) const;
    std::vector<Call> named(const std::string& call) const;
    std::vector<Call> of(const std::string& address, const std::string& call) const;
    /// Addresses of the instances that were created, in that order.
    std::vector<std::string> created() const;

    /// plugin.h, entry.h: init, factory, create (parts before holders), ..., destroy (holders before parts), deinit.
    void check_lifecycle() const;
    /// call.h, status.h: the context of every call, and every error on entry.
    void check_contexts() const;
    /// threads.h: [main] calls one at a time in the process, [worker, exclusive] ones one at a time on an instance.
    void check_threads() const;
    /// stage.h: next, emit, receive and finish of nodes in file order.
    void check_order(const std::vector<std::string>& nodes) const;
    /// stage.h: each node's finish once, in graph order, and what comes after it.
    void check_finish(const std::vector<std::string>& graph_order) const;

private:
    std::vector<Call> calls_;
};

/// The calls of the kinds that a stage gets while it runs.
bool is_run_call(const SpyLog::Call& call);

}  // namespace pelorus::test
