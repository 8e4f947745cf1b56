/// The plugins that a config names, each looked up once.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "graph/graph.hpp"
#include "graph/part_tree.hpp"

namespace pelorus::graph {

class Plugins {
public:
    explicit Plugins(PluginFinder finder) : finder_(std::move(finder)) {}

    struct Found {
        const host::LoadedPlugin* plugin = nullptr;
        std::string error;  ///< why there is none
        /// The plugin that was perhaps meant: what stands below is checked against it, so that all is told in one pass.
        const host::LoadedPlugin* meant = nullptr;
    };
    const Found& find(const std::string& id);
    /// Valid as long as this object.
    Descriptions descriptions();

private:
    PluginFinder finder_;
    std::map<std::string, Found> found_;
};

}  // namespace pelorus::graph
