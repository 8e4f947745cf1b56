/// Instances of plugins: created from plans, parts before holders; destroyed holders before parts.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <pelorus/abi/plugin.h>

#include "graph/plan.hpp"
#include "graph/problems.hpp"
#include "host/breadcrumb.hpp"
#include "host/guard/guard.hpp"
#include "host/services.hpp"

namespace pelorus::graph {

/// One instance and everything that its plr_config points to. Destroys the instance when it dies.
class Instance {
public:
    Instance(const PartPlan& plan, const host::InstanceHost::Shared& services);
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    const PartPlan& plan() const noexcept { return plan_; }
    const plr_config& config() const noexcept { return config_; }
    const plr_instance& instance() const noexcept { return instance_; }
    host::InstanceHost& host() noexcept { return host_; }

    /// As it stands in its holder's plr_config.parts: with the guard's table, where it is guarded.
    plr_part as_part() const;

private:
    friend class TreeBuilder;
    host::CallMark mark(const char* call) const noexcept;
    void set_guard(host::GuardMode mode, const std::shared_ptr<host::FaultLatch>& latch);

    const PartPlan& plan_;
    host::InstanceHost host_;
    std::vector<plr_part> parts_;
    std::vector<std::string> input_names_;
    std::vector<plr_input_place> inputs_;
    plr_config config_{};
    plr_instance instance_{};
    host::Guard guard_;  // of a model
};

struct TreeContext {
    host::InstanceHost::Shared services;
    plr_key key{};
    const char* frame = "";  ///< outlives the instances
    host::GuardMode guard = host::GuardMode::start;
};

/// All instances of a graph, in the order in which they were created.
class Instances {
public:
    Instances() = default;
    Instances(const Instances&) = delete;
    Instances& operator=(const Instances&) = delete;
    ~Instances();

    /// Creates the instances of a stage's tree and answers the stage's own. nullptr: something could not be created, and is a
    /// problem under its place in the config. The plan must outlive this object.
    Instance* create(const PartPlan& stage, const TreeContext& context, Problems& problems);

    /// Destroys them all, holders before parts.
    void clear() noexcept;

    /// What stands in slots, in the order of creation.
    std::vector<plr_part> models() const;

private:
    friend class TreeBuilder;
    std::vector<std::unique_ptr<Instance>> created_;
};

}  // namespace pelorus::graph
