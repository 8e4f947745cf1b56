/// Plugins that live in the test itself: described by a few lines, created and destroyed under observation.
#pragma once

#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pelorus/abi/abi.h>

#include "graph/document.hpp"
#include "graph/graph.hpp"

namespace pelorus::fakes {

/// A parameter under construction; strings live as long as the plugin.
class FakeParameter {
public:
    FakeParameter(std::deque<std::string>& strings, plr_parameter& raw) : strings_(strings), raw_(raw) {}
    FakeParameter& unit(const std::string& text) { return raw_.unit = keep(text), *this; }
    FakeParameter& initially(const std::string& text) {
        return raw_.default_text = keep(text), raw_.flags &= ~1u, *this;
    }
    FakeParameter& optional() { return raw_.flags = PLR_PARAMETER_OPTIONAL, *this; }
    FakeParameter& doc(const std::string& text) { return raw_.doc = keep(text), *this; }
    FakeParameter& min(double value) { return raw_.min = value, *this; }
    FakeParameter& max(double value) { return raw_.max = value, *this; }
    FakeParameter& above(double value) { return raw_.flags |= PLR_PARAMETER_MIN_EXCLUSIVE, min(value); }
    FakeParameter& below(double value) { return raw_.flags |= PLR_PARAMETER_MAX_EXCLUSIVE, max(value); }
    FakeParameter& rows(int least, int most) { return raw_.rows_min = least, raw_.rows_max = most, *this; }
    FakeParameter& cols(int least, int most) { return raw_.cols_min = least, raw_.cols_max = most, *this; }
    FakeParameter& choices(const std::vector<std::string>& words);
    FakeParameter column(const std::string& name, std::uint32_t type);

private:
    const char* keep(const std::string& text) { return strings_.emplace_back(text).c_str(); }
    std::deque<std::string>& strings_;
    plr_parameter& raw_;
};

class FakePlugins;

/// What a test can say about a plugin and its instances.
class FakePlugin {
public:
    FakePlugin(FakePlugins& owner, const std::string& id, const std::string& kind);
    FakePlugin(const FakePlugin&) = delete;
    FakePlugin& operator=(const FakePlugin&) = delete;

    FakeParameter parameter(const std::string& name, std::uint32_t type);
    FakePlugin& slot(const std::string& name, const std::string& kind, int min, int max);
    FakeParameter slot_parameter(const std::string& name, std::uint32_t type);  ///< of the last slot
    FakePlugin& input(const std::string& name, const std::string& unit, std::vector<double> defaults);
    FakePlugin& in(const std::string& name, std::uint32_t message, std::uint32_t flags = 0);
    FakePlugin& out(const std::string& name, std::uint32_t message);

    /// Called in create; an answer other than PLR_OK makes it fail. May throw.
    std::function<plr_status(const plr_config&, plr_error&)> on_create;
    /// Called on the instance that create is about to answer.
    std::function<void(plr_instance&)> on_created;
    /// What a stage's port carries or wants; {} : everything.
    std::function<plr_port_type(bool is_output, std::uint32_t port)> port_type;

    const host::LoadedPlugin& loaded();
    plr_status create(const plr_config& config, plr_instance& out, plr_error& error);

private:
    friend class FakePlugins;
    FakeParameter add(std::vector<plr_parameter>& to, const std::string& name, std::uint32_t type);

    FakePlugins& owner_;
    std::deque<std::string> strings_;
    std::string id_, kind_;
    std::vector<plr_parameter> parameters_;
    std::vector<plr_slot> slots_;
    std::deque<std::vector<plr_parameter>> slot_parameters_;
    std::vector<plr_input> inputs_;
    std::deque<std::vector<double>> input_defaults_;
    std::vector<plr_port> in_, out_;
    plr_description description_{};
    plr_plugin plugin_{};
    host::LoadedPlugin loaded_;
};

class FakePlugins {
public:
    FakePlugins();
    ~FakePlugins();
    FakePlugins(const FakePlugins&) = delete;
    FakePlugins& operator=(const FakePlugins&) = delete;

    FakePlugin& add(const std::string& id, const std::string& kind);
    FakePlugin& operator[](const std::string& id) { return *plugins_.at(id); }
    graph::PluginFinder finder();

    /// Addresses of instances in the order in which they were created, and destroyed.
    std::vector<std::string> created, destroyed;

    graph::Graph build(const std::string& yaml, const std::vector<graph::Override>& overrides = {},
                       const graph::BuildOptions& options = {});
    /// The text of the ConfigError that building throws, or "built".
    std::string problems(const std::string& yaml, const std::vector<graph::Override>& overrides = {},
                         const graph::BuildOptions& options = {});

private:
    std::map<std::string, std::unique_ptr<FakePlugin>> plugins_;
};

/// A pipeline's worth of plugins: source.fake, sensor.fake, motion.fake, estimator.fake, tracker.fake, analyzer.fake.
void add_pipeline(FakePlugins& plugins);

/// A config that uses them all.
std::string pipeline();

}  // namespace pelorus::fakes
