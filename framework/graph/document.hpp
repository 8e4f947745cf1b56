/// A config file: read, with what it extends, and the overrides that are to be laid on it.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "graph/value.hpp"
#include "host/error.hpp"

namespace pelorus::graph {

/// One `--set address=value`.
struct Override {
    std::string address;
    std::string text;  ///< YAML; `~` removes
};

/// An override whose value has been read. Values of a campaign's sweeps and variants keep their place in the file.
struct Assignment {
    std::string address;
    Location where;
    Value value;
};

class Document {
public:
    /// Reads the file, merges what it extends (maps merge key by key, lists and scalars replace, `~` removes), resolves
    /// anchors and `<<`, refuses duplicate keys. Throws ConfigError.
    ///
    /// The overrides are read here and laid on the graph by Graph::build, which knows the plugins and so what an address
    /// means: `node.parameter`, `node.slot.part.parameter`, `node.slot.parameter` (a part that stands unnamed), and so on
    /// down; `node.use`, `node.frame`, `node.in.port`, `node.slot.part.like`; a node, slot or part itself, to be given a map
    /// or `~`; `run.seed`. `graph`, `with` and `parts` are left out of addresses. The last one wins.
    static Document load(const std::filesystem::path& file, const std::vector<Override>& overrides = {});

    /// The same, from text instead of a file; `name` stands for the file in messages, `base` is the folder of its paths.
    static Document parse(const std::string& text, const std::string& name, const std::filesystem::path& base,
                          const std::vector<Override>& overrides = {});

    /// The tree as it stands in the files, without overrides.
    const Value& root() const noexcept { return root_; }
    const std::filesystem::path& file() const noexcept { return file_; }
    const std::vector<Assignment>& overrides() const noexcept { return overrides_; }

    /// Adds an override before those given to load (a sweep or a variant, which `--set` goes over).
    void assign(Assignment assignment);

    /// The `campaign:` block, or nullptr. Graph::build checks its structure and otherwise leaves it alone: it builds one run
    /// of the base config.
    const Value* campaign() const noexcept { return root_.find("campaign"); }

    /// The same without `campaign:`, which one run has no use for.
    Document without_campaign() const;

private:
    void read_overrides(const std::vector<Override>& overrides);

    Value root_;
    std::filesystem::path file_;
    std::vector<Assignment> overrides_;
    std::size_t assigned_ = 0;
};

}  // namespace pelorus::graph
