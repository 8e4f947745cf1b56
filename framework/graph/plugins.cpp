#include "graph/plugins.hpp"

#include "host/catalog.hpp"

namespace pelorus::graph {

const Plugins::Found& Plugins::find(const std::string& id) {
    const auto known = found_.find(id);
    if (known != found_.end()) return known->second;
    Found found;
    try {
        found.plugin = &finder_(id);
    } catch (const host::UnknownPlugin& error) {
        found.error = error.what();
        if (!error.meant().empty()) found.meant = find(error.meant()).plugin;
    } catch (const Error& error) {
        found.error = error.what();
    }
    return found_.emplace(id, std::move(found)).first->second;
}

Descriptions Plugins::descriptions() {
    return [this](const std::string& id) -> const plr_description* {
        if (id.empty()) return nullptr;
        const Found& found = find(id);
        const host::LoadedPlugin* const plugin = found.plugin != nullptr ? found.plugin : found.meant;
        return plugin == nullptr ? nullptr : &plugin->description();
    };
}

}  // namespace pelorus::graph
