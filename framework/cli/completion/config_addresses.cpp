#include "cli/completion/config_addresses.hpp"

#include "graph/campaign_block.hpp"
#include "graph/graph.hpp"
#include "graph/part_tree.hpp"
#include "graph/plan.hpp"
#include "host/description.hpp"
#include "host/services.hpp"

namespace pelorus::cli {

namespace {

void add_addresses(const graph::PartPlan& part, std::vector<std::string>& addresses) {
    for (const std::string& name : graph::parameter_names(part.description()))
        addresses.push_back(part.address + "." + name + "=");
    if (part.place != nullptr)
        for (std::uint32_t i = 0; i < part.place->parameter_count; ++i)
            addresses.push_back(part.address + "." + host::element(part.place->parameters, i).name + "=");
    for (const auto& below : part.parts) add_addresses(*below, addresses);
}

}  // namespace

std::vector<std::string> config_addresses(const std::string& config,
                                          const std::vector<std::filesystem::path>& folders) {
    host::set_log_level("error");
    host::Catalog catalog(folders);
    const graph::Graph graph = graph::Graph::build(graph::Document::load(config), catalog, {});
    std::vector<std::string> addresses{"run.seed="};
    for (const graph::NodePlan& node : graph.plans()) add_addresses(*node.part, addresses);
    return addresses;
}

std::vector<std::string> config_variants(const std::string& config) {
    const graph::Document document = graph::Document::load(config);
    graph::Problems problems;
    std::vector<std::string> names;
    for (const graph::Variant& variant : graph::read_campaign(document.campaign(), problems).variants)
        names.push_back(variant.name);
    return names;
}

}  // namespace pelorus::cli
