#include "embed/pipeline.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <utility>

#include "host/error.hpp"
#include "report/result_folder.hpp"
#include "runtime/time_text.hpp"

namespace pelorus::embed {
namespace {

namespace fs = std::filesystem;

/// An application that pushes and pushes at one arrival, and never lets it be handled, is stopped here.
constexpr std::size_t most_waiting = 65536;

/// Plugins are created and destroyed by one thread at a time in the whole process ([main] in the plugin ABI).
std::mutex& main_call() {
    static std::mutex* const mutex = new std::mutex;
    return *mutex;
}

}  // namespace

Pipeline::Pipeline(const graph::Document& document, const Options& options)
    : options_(options), config_(document.file().string()) {
    const std::lock_guard<std::mutex> lock(main_call());
    for (const fs::path& folder : options_.plugin_folders) {
        std::error_code reason;
        if (!fs::is_directory(folder, reason))
            throw Failure(PELORUS_E_CONFIG, "plugin folder " + folder.string() + " is no folder");
    }
    // On failure these end while the lock is still held; members would end after it.
    auto catalog = std::make_unique<host::Catalog>(host::Catalog::default_folders(options_.plugin_folders));
    graph::BuildOptions build;
    build.threads = options_.threads;
    build.variables = options_.variables;
    if (!options_.result_folder.empty()) {
        options_.result_folder = fs::absolute(options_.result_folder).lexically_normal();
        build.output_folder = options_.result_folder.string();
    }
    auto graph = std::make_unique<graph::Graph>(graph::Graph::build(document, *catalog, build));
    auto runtime = std::make_unique<runtime::Runtime>(*graph);
    if (!options_.result_folder.empty()) report::prepare_folder(options_.result_folder);
    catalog_ = std::move(catalog);
    graph_ = std::move(graph);
    runtime_ = std::move(runtime);
    describe();
}

Pipeline::~Pipeline() {
    const std::lock_guard<std::mutex> lock(main_call());
    subscriptions_.clear();
    runtime_.reset();
    graph_.reset();
}

void Pipeline::describe() {
    for (const runtime::Wiring::Node& node : runtime_->wiring().nodes) {
        nodes_.push_back({sizeof(pelorus_node_info), 0, node.name.c_str(), node.kind.c_str(), node.plugin.c_str(),
                          node.version.c_str()});
        const bool is_external = runtime::external_of(node) != nullptr;
        const auto add = [&](const runtime::Wiring::Port& port, bool is_output) {
            ports_.push_back({sizeof(pelorus_port_info), port.message, node.name.c_str(), port.name.c_str(), is_output,
                              is_external && !is_output, static_cast<std::uint32_t>(port.streams.size()), 0,
                              port.streams.empty() ? nullptr : port.streams.data()});
        };
        for (const runtime::Wiring::Port& port : node.in_ports) add(port, false);
        for (const runtime::Wiring::Port& port : node.out_ports) add(port, true);
    }
}

runtime::Address Pipeline::find_port(const std::string& port, bool is_output) const {
    std::vector<std::string> names;
    const auto& nodes = runtime_->wiring().nodes;
    for (std::size_t node = 0; node < nodes.size(); ++node) {
        const auto& ports = is_output ? nodes[node].out_ports : nodes[node].in_ports;
        for (std::size_t i = 0; i < ports.size(); ++i) {
            names.push_back(nodes[node].name + "." + ports[i].name);
            if (names.back() == port) return {node, i};
        }
    }
    const std::string near = nearest(port, names);
    throw Failure(PELORUS_E_NOT_FOUND, std::string("there is no ") + (is_output ? "out" : "in") + " port '" + port +
                                           "'" + (near.empty() ? "" : "; did you mean '" + near + "'?"));
}

void Pipeline::require_alive() const {
    if (!broken_.empty()) throw Failure(PELORUS_E_BROKEN, "the pipeline failed before: " + broken_);
    if (finished_) throw Failure(PELORUS_E_FINISHED, "the pipeline was finished");
}

bool Pipeline::may_go_on() {
    halted_by_stop_ = stop_.exchange(false);
    return !halted_by_stop_ && std::none_of(subscriptions_.begin(), subscriptions_.end(),
                                            [](const auto& subscription) { return subscription->is_full(); });
}

void Pipeline::check_step(runtime::Step step) {
    if (step == runtime::Step::done) return;
    if (halted_by_stop_) throw Failure(PLR_E_CANCELLED, "stopped by the application");
    for (const auto& subscription : subscriptions_) {
        if (!subscription->is_full()) continue;
        const runtime::Wiring::Node& node = runtime_->wiring().nodes[subscription->port().node];
        throw Failure(PELORUS_E_FULL,
                      "the subscription of " + node.name + "." + node.out_ports[subscription->port().port].name +
                          " is full: " + std::to_string(subscription->waiting()) + " messages wait to be pulled");
    }
}

/// Part of the run: what fails in it breaks the pipeline, unless the message itself was refused.
template <class Work> void Pipeline::go_on(Work work) {
    require_alive();
    results_.reset();
    const auto start = std::chrono::steady_clock::now();
    const auto add_time = [&] {
        seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    try {
        work();
        return add_time();
    } catch (const Failure&) {
        add_time();
        throw;
    } catch (const runtime::BadMessage&) {
        add_time();
        throw;
    } catch (const std::exception& problem) {
        add_time();
        broken_ = problem.what();
    }
    std::string text = broken_;
    try {
        write_results(true);
    } catch (const std::exception& problem) {
        text += std::string("; then ") + problem.what();
    }
    throw Failure(PELORUS_E_FAILED, text);
}

void Pipeline::push(const std::string& port, const plr_message& message) {
    go_on([&] {
        const runtime::Address in_port = find_port(port, false);
        if (runtime_->waiting() >= most_waiting)
            throw Failure(PELORUS_E_FULL, std::to_string(runtime_->waiting()) +
                                              " messages wait to be handled: advance before pushing more");
        const runtime::Delivery delivery = runtime_->deliver(in_port, message, [this] { return may_go_on(); });
        check_step(delivery == runtime::Delivery::halted ? runtime::Step::halted : runtime::Step::done);
    });
}

void Pipeline::advance(std::int64_t until) {
    go_on([&] { check_step(runtime_->advance(until, [this] { return may_go_on(); })); });
}

void Pipeline::play() {
    go_on([&] { check_step(runtime_->play([this] { return may_go_on(); })); });
}

void Pipeline::finish() {
    go_on([&] {
        runtime_->finish();
        finished_ = true;
        write_results(false);
    });
}

void Pipeline::write_results(bool stopped) {
    if (options_.result_folder.empty()) return;
    report::RunContext context;
    context.config = config_;
    context.stopped = stopped;
    report::write_result_folder(options_.result_folder, *graph_, report::cell_of_run(runtime_->results()),
                                report::timings_of(*graph_, *runtime_, seconds_), context);
}

Subscription& Pipeline::subscribe(const std::string& port, std::size_t capacity, bool drops_oldest) {
    const runtime::Address out_port = find_port(port, true);
    subscriptions_.push_back(std::make_unique<Subscription>(out_port, capacity, drops_oldest));
    observe(out_port);
    return *subscriptions_.back();
}

/// Everybody who has subscribed to a port gets what it publishes.
void Pipeline::observe(const runtime::Address& port) {
    std::vector<Subscription*> all;
    for (const auto& subscription : subscriptions_)
        if (subscription->port().node == port.node && subscription->port().port == port.port)
            all.push_back(subscription.get());
    if (all.empty()) return runtime_->observe(port, nullptr);
    runtime_->observe(port, [all = std::move(all)](const runtime::MessageRef& message) {
        for (Subscription* subscription : all) subscription->take(message);
    });
}

void Pipeline::unsubscribe(const Subscription& subscription) {
    const auto found = std::find_if(subscriptions_.begin(), subscriptions_.end(),
                                    [&](const auto& one) { return one.get() == &subscription; });
    if (found == subscriptions_.end()) return;
    const runtime::Address port = subscription.port();
    const std::unique_ptr<Subscription> last_of_it = std::move(*found);
    subscriptions_.erase(found);
    observe(port);
}

const Results& Pipeline::results() {
    if (!results_)
        results_ = std::make_unique<Results>(report::cell_of_run(runtime_->results()),
                                             report::timings_of(*graph_, *runtime_, seconds_));
    return *results_;
}

std::vector<unsigned char> Pipeline::snapshot() {
    require_alive();
    try {
        return runtime_->snapshot();
    } catch (const Error& problem) {  // nothing has changed: the pipeline goes on
        throw Failure(PLR_E_UNSUPPORTED, problem.what());
    }
}

void Pipeline::restore(const std::vector<unsigned char>& bytes) {
    require_alive();
    results_.reset();
    try {
        runtime_->restore(bytes);
    } catch (const Error& problem) {
        if (runtime_->is_broken()) broken_ = problem.what();
        throw Failure(PLR_E_DATA, problem.what());
    }
}

}  // namespace pelorus::embed
