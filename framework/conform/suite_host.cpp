#include "conform/suite_host.hpp"

#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "graph/contract.hpp"
#include "graph/names.hpp"
#include "graph/parameters.hpp"
#include "graph/part_tree.hpp"
#include "graph/yaml.hpp"
#include "host/description.hpp"
#include "host/manifest.hpp"
#include "runtime/message_copy.hpp"

namespace pelorus::conform {

namespace {

using conformance::Node;
using conformance::Refused;
using conformance::Subject;

struct ValueSettings : conformance::Settings {
    explicit ValueSettings(graph::Value value_) : value(std::move(value_)) {}
    graph::Value value;
};

graph::Value empty_map() {
    graph::Value map;
    map.kind = graph::Value::Kind::map;
    return map;
}

const graph::Value& value_of(const conformance::Settings* with) {
    static const graph::Value none = empty_map();
    return with == nullptr ? none : static_cast<const ValueSettings&>(*with).value;
}

struct ReadValues : conformance::Values {
    explicit ReadValues(graph::ParameterSet set_) : set(std::move(set_)) {}
    const plr_value* data() const override { return set.data(); }
    std::uint32_t size() const override { return set.size(); }
    graph::ParameterSet set;
};

struct PoolThreads : conformance::Threads {
    explicit PoolThreads(unsigned count) : pool(count) {}
    const plr_parallel& service() const override { return pool.service(); }
    host::ThreadPool pool;
};

std::optional<std::string> environment(const std::string& name) {
    const char* const value = std::getenv(name.c_str());
    return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

/// A file of subjects, from YAML to nodes.
class SubjectReader {
public:
    explicit SubjectReader(graph::Problems& problems) : problems_(problems) {}

    Node node(const graph::Value& value, const std::string& slot, const std::string& name) const {
        Node node;
        node.slot = slot;
        node.name = name;
        if (!value.is_map()) {
            problems_.add(value.where, "expected a map with use, with, parts or frame, got " + value.described());
            return node;
        }
        for (const graph::Value::Entry& entry : value.map) {
            if (entry.key == "use")
                node.use = word(entry.value);
            else if (entry.key == "frame")
                node.frame = word(entry.value);
            else if (entry.key == "with")
                node.with = std::make_shared<ValueSettings>(entry.value);
            else if (entry.key == "parts")
                add_parts(entry.value, node);
            else
                problems_.add(entry.where, "unknown key '" + entry.key + "'" +
                                               graph::suggestion(entry.key, {"use", "with", "parts", "frame"}, "keys"));
        }
        if (node.use.empty()) problems_.add(value.where, "use: is missing: the id of a plugin");
        return node;
    }

private:
    std::string word(const graph::Value& value) const {
        if (value.is_scalar()) return value.scalar;
        problems_.add(value.where, "expected a word, got " + value.described());
        return {};
    }
    void add_parts(const graph::Value& slots, Node& node) const {
        for (const graph::Value::Entry& slot : slots.map) {
            if (graph::is_unnamed_part(slot.value)) {
                node.parts.push_back(this->node(slot.value, slot.key, ""));
                continue;
            }
            for (const graph::Value::Entry& part : slot.value.map)
                node.parts.push_back(this->node(part.value, slot.key, part.key));
        }
    }
    graph::Problems& problems_;
};

/// The host's errors in the suites' words.
template <class Body> decltype(auto) refusing(Body&& body) {
    try {
        return body();
    } catch (const Refused&) {
        throw;
    } catch (const std::exception& problem) {
        throw Refused(problem.what());
    }
}

}  // namespace

std::vector<conformance::ManifestEntry> SuiteHost::manifests(const std::filesystem::path& library) const {
    const host::Manifests found = host::read_manifests(library);
    if (!found.problem.empty()) throw Refused(library.string() + ": " + found.problem);
    std::vector<conformance::ManifestEntry> entries;
    for (const host::PluginFile& file : found.plugins)
        entries.push_back({file.id, file.kind, file.table_id, file.version, file.abi_major, file.abi_minor});
    return entries;
}

std::shared_ptr<const conformance::Settings> SuiteHost::settings(const std::string& yaml,
                                                                 const conformance::Settings* below) const {
    return refusing([&] {
        graph::Value value = value_of(below);
        graph::Value over = graph::read_yaml(yaml, {Location("setting"), {}, {}});
        if (over.is_map()) graph::merge(value, std::move(over));
        return std::make_shared<const ValueSettings>(std::move(value));
    });
}

std::unique_ptr<conformance::Values> SuiteHost::values(const plr_parameter* first, std::uint32_t count,
                                                       const conformance::Settings* with,
                                                       const std::string& plugin) const {
    return refusing([&] {
        const graph::Value& map = value_of(with);
        graph::Problems problems;
        auto read = std::make_unique<ReadValues>(
            graph::read_parameters(first, count, map, {problems, "subject", plugin, map.where, map.base, environment}));
        problems.raise();
        return std::unique_ptr<conformance::Values>(std::move(read));
    });
}

std::vector<std::string> SuiteHost::keys(const conformance::Settings& with) const {
    return static_cast<const ValueSettings&>(with).value.keys();
}

void SuiteHost::check_keys(const conformance::Settings& with, const std::vector<std::string>& known,
                           const std::string& plugin) const {
    refusing([&] {
        graph::Problems problems;
        for (const graph::Value::Entry& entry : static_cast<const ValueSettings&>(with).value.map)
            if (std::find(known.begin(), known.end(), entry.key) == known.end())
                problems.add(entry.where, plugin + " has no parameter '" + entry.key + "'" +
                                              graph::suggestion(entry.key, known, "parameters"));
        problems.raise();
    });
}

std::vector<Subject> SuiteHost::subjects(const std::filesystem::path& file) const {
    return refusing([&] {
        std::ifstream stream(file, std::ios::binary);
        std::ostringstream text;
        text << stream.rdbuf();
        if (!stream) throw Refused(file.string() + ": cannot be read");
        const graph::Value map =
            graph::read_yaml(text.str(), {Location(file.string(), 1, 1), file.string(), file.parent_path()});
        graph::Problems problems;
        if (!map.is_map() || map.map.empty()) problems.add(map.where, "expected a map of titles to subjects");
        std::vector<Subject> subjects;
        for (const graph::Value::Entry& entry : map.map) {
            Subject subject;
            subject.title = entry.key;
            subject.node = SubjectReader(problems).node(entry.value, "", "");
            subject.plugin = std::exchange(subject.node.use, "");
            subjects.push_back(std::move(subject));
        }
        problems.raise();
        return subjects;
    });
}

std::string SuiteHost::description_problem(const plr_description& description) const {
    return host::description_problem(description);
}

std::string SuiteHost::instance_problem(const plr_plugin& plugin, const plr_instance& instance) const {
    return graph::instance_problem(plugin.table_id, *plugin.description, instance);
}

const plr_plugin& SuiteHost::plugin(const std::string& id) const {
    return refusing([&]() -> const plr_plugin& { return *catalog_.load(id).plugin; });
}

std::unique_ptr<conformance::Threads> SuiteHost::threads(unsigned count) const {
    return std::make_unique<PoolThreads>(count);
}

std::shared_ptr<const plr_message> SuiteHost::copy(const plr_message& message) const {
    return refusing([&] {
        runtime::check_message(message, check_memory_);
        auto copied = std::make_shared<runtime::MessageRef>(runtime::copy_message(messages_, message));
        return std::shared_ptr<const plr_message>(copied, &**copied);
    });
}

void SuiteHost::check_stream(const plr_message& message, const plr_port_type& declared) const {
    refusing([&] {
        std::vector<plr_stream> streams;
        for (std::uint32_t i = 0; i < declared.stream_count; ++i) streams.push_back(host::element(declared.streams, i));
        runtime::check_stream(message, streams);
        return 0;
    });
}

}  // namespace pelorus::conform
