#include "cli/instance_json.hpp"

#include <memory>
#include <optional>

#include <pelorus/abi/abi.h>

#include "cli/value_json.hpp"
#include "graph/instance.hpp"
#include "graph/plan.hpp"
#include "graph/yaml.hpp"
#include "host/description.hpp"
#include "host/services.hpp"

namespace pelorus::cli {

namespace {

using Json = nlohmann::ordered_json;

Json space_json(const plr_space& space, bool has_priors) {
    Json list = Json::array();
    for (std::uint32_t i = 0; i < space.size; ++i) {
        const plr_component& component = host::element(space.components, i);
        Json json{{"name", component.name}, {"unit", component.unit}};
        if ((component.flags & PLR_COMPONENT_ANGLE) != 0) json["angle"] = true;
        if (has_priors) json["prior"] = {{"mean", component.prior_mean}, {"deviation", component.prior_deviation}};
        list.push_back(std::move(json));
    }
    return list;
}

/// A table's answer to info().
template <class Table> const auto& info_of(const plr_instance& instance) {
    return *reinterpret_cast<const Table*>(instance.table)->info(instance.self);
}

void tell_motion(const plr_instance& instance, Json& json) {
    const plr_motion_info& info = info_of<plr_motion>(instance);
    json["spaces"]["state"] = space_json(*info.state, true);
    if (info.cartesian != info.state) json["spaces"]["Cartesian"] = space_json(*info.cartesian, false);
    json["record"] = info.record_size;
}

void tell_sensor(const plr_instance& instance, Json& json) {
    const plr_sensor_info& info = info_of<plr_sensor>(instance);
    json["spaces"]["measurement"] = space_json(*info.measurement, false);
    json["spaces"]["Cartesian"] = space_json(*info.cartesian, false);
    if (info.inverse != nullptr) json["spaces"]["inverse"] = space_json(*info.inverse, false);
    if (info.waveform != nullptr) json["spaces"]["waveform"] = space_json(*info.waveform, true);
}

void tell_estimator(const plr_instance& instance, Json& json) {
    const plr_estimator_info& info = info_of<plr_estimator>(instance);
    json["spaces"]["state"] = space_json(*info.state, false);
    json["spaces"]["Cartesian"] = space_json(*info.cartesian, true);
    json["record"] = info.record_size;
}

void tell_extent(const plr_instance& instance, Json& json) {
    const plr_extent_info& info = info_of<plr_extent>(instance);
    json["dimension"] = info.dimension;
    json["record"] = info.record_size;
}

void tell_partitioner(const plr_instance& instance, Json& json) {
    const plr_partitioner_info& info = info_of<plr_partitioner>(instance);
    json["dimension"] = {{"min", info.dimension_min}, {"max", info.dimension_max}};
}

void tell_waveform(const plr_instance& instance, Json& json) {
    const plr_waveform_info& info = info_of<plr_waveform>(instance);
    json["spaces"]["measurement"] = space_json(*info.measurement, false);
    json["spaces"]["waveform"] = space_json(*info.waveform, true);
    json["horizon"] = info.horizon;
}

void tell_trajectory(const plr_instance& instance, Json& json) {
    const plr_trajectory_info& info = info_of<plr_trajectory>(instance);
    json["spaces"]["state"] = space_json(*info.state, false);
    json["objects"] = info.objects;
    json["dimension"] = info.extent_dimension;
    json["record"] = info.record_size;
}

struct Teller {
    const char* table_id;
    void (*tell)(const plr_instance&, Json&);
};
constexpr Teller tellers[] = {
    {PLR_MOTION, &tell_motion},         {PLR_SENSOR, &tell_sensor},           {PLR_ESTIMATOR, &tell_estimator},
    {PLR_EXTENT, &tell_extent},         {PLR_PARTITIONER, &tell_partitioner}, {PLR_WAVEFORM, &tell_waveform},
    {PLR_TRAJECTORY, &tell_trajectory},
};

Json extensions_json(const plr_instance& instance) {
    Json list = Json::array();
    if (instance.table->extension == nullptr) return list;
    for (const char* id : {PLR_MOTION_STRUCTURE, PLR_MOTION_NOISE_FACTOR, PLR_ESTIMATOR_MIX, PLR_ESTIMATOR_MODES,
                           PLR_ESTIMATOR_SMOOTHED, PLR_EXTENT_JOINT, PLR_RECORD_CONVERT})
        if (instance.table->extension(instance.self, id) != nullptr) list.push_back(id);
    return list;
}

std::string first_problem(const graph::Problems& problems) {
    return problems.empty() ? "it cannot be made" : problems.items().front().text;
}

}  // namespace

Json instance_json(const Json& part, const graph::PluginFinder& finder) {
    graph::Problems problems;
    graph::Plugins plugins(finder);
    const auto variable = [](const std::string&) { return std::optional<std::string>(); };
    const graph::Value written = graph::read_yaml(flow_text(part), {Location("example"), {}, {}});
    const std::unique_ptr<graph::PartPlan> plan =
        graph::plan_part(written, part["use"].get<std::string>(), {plugins, problems, {}, variable});
    if (plan == nullptr || !problems.empty()) return {{"unavailable", first_problem(problems)}};

    const host::FrameTree frames;
    const host::ThreadPool pool(1);
    graph::Instances instances;  // after what they use: they go first
    const graph::Instance* const made = instances.create(*plan, {{&frames, &pool, nullptr}, {}, ""}, problems);
    if (made == nullptr) return {{"unavailable", first_problem(problems)}};
    Json json = Json::object();
    for (const Teller& teller : tellers)
        if (made->plan().plugin->file.table_id == std::string(teller.table_id)) teller.tell(made->instance(), json);
    const Json extensions = extensions_json(made->instance());
    if (!extensions.empty()) json["extensions"] = extensions;
    return json;
}

}  // namespace pelorus::cli
