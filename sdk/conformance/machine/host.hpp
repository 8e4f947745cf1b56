/// What the suites need of a host: to read manifests and parameter values as it does, and the services that plugins are given.
/// The suites know this interface alone; whoever makes a runner of them (the Pelorus host does) implements it.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <pelorus/abi/abi.h>

namespace pelorus::conformance {

/// Something that the host refuses, in one line.
struct Refused : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A map of parameters as a config has it, not yet read.
class Settings {
public:
    virtual ~Settings() = default;
};

/// Values in the order of the description, as plr_config holds them.
class Values {
public:
    virtual ~Values() = default;
    virtual const plr_value* data() const = 0;
    virtual std::uint32_t size() const = 0;
};

/// A plugin in a slot or under test: its id and values, and what stands in its own slots.
struct Node {
    std::string slot, name;  ///< where it stands in its holder
    std::string use;         ///< a plugin's id; "" for the plugin under test
    std::shared_ptr<const Settings> with;
    std::vector<Node> parts;
    std::string frame;  ///< of stages
};

/// What is put to the test: the plugin under one set of values.
struct Subject {
    std::string title;   ///< `form: truncated`; "" for the defaults
    std::string plugin;  ///< its id
    Node node;
};

/// Work on several threads, as plr_parallel.
class Threads {
public:
    virtual ~Threads() = default;
    virtual const plr_parallel& service() const = 0;
};

struct ManifestEntry {
    std::string id, kind, table_id, version;
    std::uint16_t abi_major = 0, abi_minor = 0;
};

class Host {
public:
    virtual ~Host() = default;

    /// The manifests in a library's file; nothing is loaded. Throws Refused.
    virtual std::vector<ManifestEntry> manifests(const std::filesystem::path& library) const = 0;

    /// A YAML map (`{form: truncated}`), laid over another one. Throws Refused.
    virtual std::shared_ptr<const Settings> settings(const std::string& yaml, const Settings* below) const = 0;
    /// The described parameters, defaults included. Keys that are not described are left alone. Throws Refused.
    virtual std::unique_ptr<Values> values(const plr_parameter* first, std::uint32_t count, const Settings* with,
                                           const std::string& plugin) const = 0;
    /// Keys of the map.
    virtual std::vector<std::string> keys(const Settings& with) const = 0;
    /// Throws Refused for the first key of the map that is none of these: where it stands, and what may have been meant.
    virtual void check_keys(const Settings& with, const std::vector<std::string>& known,
                            const std::string& plugin) const = 0;
    /// The subjects that a file describes: a map of titles to `use`, `with`, `parts`, `frame`. Throws Refused.
    virtual std::vector<Subject> subjects(const std::filesystem::path& file) const = 0;

    /// What the host finds wrong with a description, as one line, or "".
    virtual std::string description_problem(const plr_description& description) const = 0;
    /// What the host finds wrong with a fresh instance: its table, and what it says of itself. "" if nothing.
    virtual std::string instance_problem(const plr_plugin& plugin, const plr_instance& instance) const = 0;

    /// A plugin where the host looks for plugins. Throws Refused.
    virtual const plr_plugin& plugin(const std::string& id) const = 0;

    virtual const plr_random& random() const = 0;
    virtual const plr_frames& frames() const = 0;
    virtual std::unique_ptr<Threads> threads(unsigned count) const = 0;
    /// Checks a message as the host does when it is published, and copies it. Throws Refused.
    virtual std::shared_ptr<const plr_message> copy(const plr_message& message) const = 0;
    /// Whether what flows out of one port may flow into another, as the host decides. Throws Refused, which says why not.
    virtual void check_stream(const plr_message& message, const plr_port_type& declared) const = 0;
};

}  // namespace pelorus::conformance
