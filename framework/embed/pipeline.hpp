/// A pipeline as an application holds it. Throws Failure (and what the host throws); embed.cpp turns that into statuses.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pelorus/embed.h>

#include "embed/failure.hpp"
#include "embed/results.hpp"
#include "embed/subscription.hpp"
#include "graph/graph.hpp"
#include "host/catalog.hpp"
#include "runtime/runtime.hpp"

namespace pelorus::embed {

struct Options {
    unsigned threads = 1;  ///< 0: one a core
    std::vector<std::filesystem::path> plugin_folders;
    std::vector<graph::Override> overrides;
    std::map<std::string, std::string> variables;
    std::filesystem::path result_folder;  ///< empty: none
};

class Pipeline {
public:
    /// Throws what Graph::build throws.
    Pipeline(const graph::Document& document, const Options& options);
    ~Pipeline();
    Pipeline(const Pipeline&) = delete;
    Pipeline& operator=(const Pipeline&) = delete;

    const std::vector<pelorus_node_info>& nodes() const noexcept { return nodes_; }
    const std::vector<pelorus_port_info>& ports() const noexcept { return ports_; }

    void push(const std::string& port, const plr_message& message);
    void advance(std::int64_t until);
    void play();
    void finish();
    void stop() noexcept { stop_ = true; }
    std::optional<std::int64_t> now() const noexcept { return runtime_->now(); }

    Subscription& subscribe(const std::string& port, std::size_t capacity, bool drops_oldest);
    void unsubscribe(const Subscription& subscription);

    const Results& results();
    std::vector<unsigned char> snapshot();
    void restore(const std::vector<unsigned char>& bytes);

private:
    template <class Work> void go_on(Work work);
    void require_alive() const;
    bool may_go_on();
    void check_step(runtime::Step step);
    runtime::Address find_port(const std::string& port, bool is_output) const;
    void describe();
    void observe(const runtime::Address& port);
    void write_results(bool stopped);

    // In this order: what is below uses what is above.
    Options options_;
    std::string config_;  // the file's name, for provenance.json
    std::unique_ptr<host::Catalog> catalog_;
    std::unique_ptr<graph::Graph> graph_;
    std::unique_ptr<runtime::Runtime> runtime_;
    std::vector<std::unique_ptr<Subscription>> subscriptions_;
    std::vector<pelorus_node_info> nodes_;
    std::vector<pelorus_port_info> ports_;
    std::unique_ptr<Results> results_;  // or nullptr: to be made
    std::atomic<bool> stop_{false};
    bool halted_by_stop_ = false;
    bool finished_ = false;
    std::string broken_;  // why, or ""
    double seconds_ = 0;  // within steps
};

}  // namespace pelorus::embed
