#include "graph_fakes.hpp"

#include <array>
#include <stdexcept>
#include <utility>

namespace pelorus::fakes {

namespace {

/// An instance of a fake plugin.
struct Self {
    FakePlugins* owner;
    FakePlugin* plugin;
    std::string address;
};

const plr_component components[] = {{sizeof(plr_component), 0, "position.x", "m", 0, 1},
                                    {sizeof(plr_component), 0, "position.y", "m", 0, 1}};
const plr_space space{sizeof(plr_space), 2, components};
const plr_motion_info motion_info{sizeof(plr_motion_info), 0, &space, &space, 0, 0, 0, 0};
const plr_sensor_info sensor_info{sizeof(plr_sensor_info), 0, &space, &space, nullptr, nullptr, 0};
const plr_estimator_info estimator_info{sizeof(plr_estimator_info), 0, &space, &space, 6, 0, 0, nullptr, 0};

void destroy(void* self) {
    auto* instance = static_cast<Self*>(self);
    instance->owner->destroyed.push_back(instance->address);
    delete instance;
}

template <class Args> plr_status answer(const void*, const plr_call*, const Args*) { return PLR_OK; }

template <class Table> plr_table_head head() { return {sizeof(Table), 0, destroy, nullptr}; }

const plr_motion motion_table{head<plr_motion>(),
                              [](const void*) { return &motion_info; },
                              answer<plr_motion_propagate>,
                              answer<plr_motion_jacobian>,
                              answer<plr_motion_noise>,
                              nullptr,
                              nullptr,
                              nullptr,
                              nullptr};

const plr_sensor sensor_table{head<plr_sensor>(),
                              [](const void*) { return &sensor_info; },
                              answer<plr_sensor_measure>,
                              answer<plr_sensor_jacobian>,
                              answer<plr_sensor_noise>,
                              answer<plr_sensor_residual>,
                              nullptr};

const plr_estimator estimator_table{head<plr_estimator>(),
                                    [](const void*) { return &estimator_info; },
                                    answer<plr_estimator_init>,
                                    answer<plr_estimator_predict>,
                                    answer<plr_estimator_project>,
                                    answer<plr_estimator_update>,
                                    answer<plr_estimator_moments>,
                                    answer<plr_estimator_moments>,
                                    nullptr};

plr_status port_type(const void* self, std::uint32_t is_output, std::uint32_t port, plr_port_type* out, plr_error*) {
    const auto& ask = static_cast<const Self*>(self)->plugin->port_type;
    if (ask) *out = ask(is_output != 0, port);
    return PLR_OK;
}

const plr_stage stage_table{
    head<plr_stage>(),
    port_type,
    [](void*, const plr_call*, plr_next*) -> plr_status { return PLR_OK; },
    [](void*, const plr_call*) -> plr_status { return PLR_OK; },
    [](void*, const plr_call*, std::uint32_t, const plr_message*) -> plr_status { return PLR_OK; },
    [](void*, const plr_call*) -> plr_status { return PLR_OK; },
    nullptr,
    nullptr};

/// plr_plugin.create has no context: each fake plugin gets a function of its own.
constexpr std::size_t most_plugins = 32;
std::array<FakePlugin*, most_plugins> registered{};

template <std::size_t N> plr_status create(const plr_config* config, plr_instance* out, plr_error* error) {
    return registered[N]->create(*config, *out, *error);
}

using Create = plr_status (*)(const plr_config*, plr_instance*, plr_error*);
template <std::size_t... N> constexpr std::array<Create, most_plugins> creators(std::index_sequence<N...>) {
    return {create<N>...};
}

Create register_plugin(FakePlugin* plugin) {
    constexpr auto functions = creators(std::make_index_sequence<most_plugins>());
    for (std::size_t i = 0; i < most_plugins; ++i) {
        if (registered[i] != nullptr) continue;
        registered[i] = plugin;
        return functions[i];
    }
    throw std::logic_error("too many fake plugins");
}

const char* table_of(const std::string& kind) {
    if (kind == "motion") return PLR_MOTION;
    if (kind == "sensor") return PLR_SENSOR;
    if (kind == "estimator") return PLR_ESTIMATOR;
    return PLR_STAGE;
}

}  // namespace

FakeParameter& FakeParameter::choices(const std::vector<std::string>& words) {
    // The pointers are kept in a string's memory, so that they live as long as the plugin.
    std::string& memory = strings_.emplace_back(words.size() * sizeof(const char*), '\0');
    auto* pointers = reinterpret_cast<const char**>(memory.data());
    for (std::size_t i = 0; i < words.size(); ++i) pointers[i] = keep(words[i]);
    raw_.choices = pointers;
    raw_.choice_count = static_cast<std::uint32_t>(words.size());
    return *this;
}

FakeParameter FakeParameter::column(const std::string& name, std::uint32_t type) {
    constexpr std::size_t most_columns = 8;
    if (raw_.columns == nullptr)
        raw_.columns = reinterpret_cast<const plr_parameter*>(
            strings_.emplace_back(most_columns * sizeof(plr_parameter), '\0').data());
    auto& column = const_cast<plr_parameter&>(raw_.columns[raw_.column_count++]);
    column = {};
    column.struct_size = sizeof(plr_parameter);
    column.type = type;
    column.flags = PLR_PARAMETER_REQUIRED;
    column.name = keep(name);
    column.doc = column.unit = "";
    column.min = -std::numeric_limits<double>::infinity();
    column.max = std::numeric_limits<double>::infinity();
    return FakeParameter(strings_, column);
}

FakePlugin::FakePlugin(FakePlugins& owner, const std::string& id, const std::string& kind)
    : owner_(owner), id_(id), kind_(kind) {
    parameters_.reserve(16);
    plugin_ = {sizeof(plr_plugin), 0, &description_, table_of(kind), register_plugin(this)};
}

FakeParameter FakePlugin::add(std::vector<plr_parameter>& to, const std::string& name, std::uint32_t type) {
    plr_parameter raw{};
    raw.struct_size = sizeof raw;
    raw.type = type;
    raw.flags = PLR_PARAMETER_REQUIRED;
    raw.name = strings_.emplace_back(name).c_str();
    raw.doc = raw.unit = "";
    raw.min = -std::numeric_limits<double>::infinity();
    raw.max = std::numeric_limits<double>::infinity();
    raw.rows_max = raw.cols_max = -1;
    to.push_back(raw);
    return FakeParameter(strings_, to.back());
}

FakeParameter FakePlugin::parameter(const std::string& name, std::uint32_t type) {
    return add(parameters_, name, type);
}

FakePlugin& FakePlugin::slot(const std::string& name, const std::string& kind, int min, int max) {
    slot_parameters_.emplace_back().reserve(8);
    slots_.push_back({sizeof(plr_slot), min, max, 0, strings_.emplace_back(name).c_str(),
                      strings_.emplace_back(kind).c_str(), "", nullptr});
    return *this;
}

FakeParameter FakePlugin::slot_parameter(const std::string& name, std::uint32_t type) {
    return add(slot_parameters_.back(), name, type);
}

FakePlugin& FakePlugin::input(const std::string& name, const std::string& unit, std::vector<double> defaults) {
    input_defaults_.push_back(std::move(defaults));
    inputs_.push_back({sizeof(plr_input), static_cast<std::uint32_t>(input_defaults_.back().size()),
                       strings_.emplace_back(name).c_str(), strings_.emplace_back(unit).c_str(), "",
                       input_defaults_.back().data()});
    return *this;
}

FakePlugin& FakePlugin::in(const std::string& name, std::uint32_t message, std::uint32_t flags) {
    in_.push_back({sizeof(plr_port), flags, strings_.emplace_back(name).c_str(), "", message, 0});
    return *this;
}

FakePlugin& FakePlugin::out(const std::string& name, std::uint32_t message) {
    out_.push_back({sizeof(plr_port), 0, strings_.emplace_back(name).c_str(), "", message, 0});
    return *this;
}

const host::LoadedPlugin& FakePlugin::loaded() {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        slots_[i].parameters = slot_parameters_[i].data();
        slots_[i].parameter_count = static_cast<std::uint32_t>(slot_parameters_[i].size());
    }
    description_ = {sizeof(plr_description),
                    0,
                    id_.c_str(),
                    kind_.c_str(),
                    "1.0.0",
                    "",
                    "",
                    "",
                    "",
                    "",
                    parameters_.data(),
                    inputs_.data(),
                    slots_.data(),
                    in_.data(),
                    out_.data(),
                    static_cast<std::uint32_t>(parameters_.size()),
                    static_cast<std::uint32_t>(inputs_.size()),
                    static_cast<std::uint32_t>(slots_.size()),
                    static_cast<std::uint32_t>(in_.size()),
                    static_cast<std::uint32_t>(out_.size()),
                    0};
    loaded_.plugin = &plugin_;
    loaded_.file.id = id_;
    loaded_.file.kind = kind_;
    loaded_.file.table_id = plugin_.table_id;
    return loaded_;
}

plr_status FakePlugin::create(const plr_config& config, plr_instance& out, plr_error& error) {
    if (on_create) {
        const plr_status status = on_create(config, error);
        if (status != PLR_OK) return status;
    }
    const plr_table_head* table = &stage_table.head;
    if (kind_ == "motion") table = &motion_table.head;
    if (kind_ == "sensor") table = &sensor_table.head;
    if (kind_ == "estimator") table = &estimator_table.head;
    out = {new Self{&owner_, this, config.address}, table};
    owner_.created.emplace_back(config.address);
    if (on_created) on_created(out);
    return PLR_OK;
}

FakePlugins::FakePlugins() = default;
FakePlugins::~FakePlugins() { registered.fill(nullptr); }

FakePlugin& FakePlugins::add(const std::string& id, const std::string& kind) {
    return *plugins_.emplace(id, std::make_unique<FakePlugin>(*this, id, kind)).first->second;
}

graph::PluginFinder FakePlugins::finder() {
    return [this](const std::string& id) -> const host::LoadedPlugin& {
        const auto found = plugins_.find(id);
        if (found == plugins_.end()) throw Error(Exit::misuse, "no plugin " + id);
        return found->second->loaded();
    };
}

graph::Graph FakePlugins::build(const std::string& yaml, const std::vector<graph::Override>& overrides,
                                const graph::BuildOptions& options) {
    return graph::Graph::build(graph::Document::parse(yaml, "test.yaml", "/configs", overrides), finder(), options);
}

std::string FakePlugins::problems(const std::string& yaml, const std::vector<graph::Override>& overrides,
                                  const graph::BuildOptions& options) {
    try {
        build(yaml, overrides, options);
        return "built";
    } catch (const ConfigError& error) {
        return error.what();
    }
}

void add_pipeline(FakePlugins& plugins) {
    FakePlugin& sensor = plugins.add("sensor.fake", "sensor");
    sensor.parameter("noise", PLR_TYPE_DOUBLE).unit("m").initially("1 m").above(0);
    sensor.input("bias", "m", {0, 0});
    FakePlugin& motion = plugins.add("motion.fake", "motion");
    motion.parameter("form", PLR_TYPE_CHOICE).initially("exact").choices({"exact", "truncated"});
    motion.parameter("rate", PLR_TYPE_DOUBLE).unit("1/s").initially("0.1 1/s").min(0);
    motion.input("normal", "", {0, 0, 1});
    FakePlugin& estimator = plugins.add("estimator.fake", "estimator");
    estimator.slot("motion", "motion", 1, 1).slot("sensors", "sensor", 1, -1);
    FakePlugin& source = plugins.add("source.fake", "source");
    source.parameter("period", PLR_TYPE_DOUBLE).unit("s").initially("1 s").above(0);
    source.parameter("scans", PLR_TYPE_INT).initially("10").min(1);
    source.slot("sensors", "sensor", 1, -1);
    source.slot_parameter("detection_probability", PLR_TYPE_DOUBLE).initially("1").min(0).max(1);
    source.slot_parameter("period", PLR_TYPE_DOUBLE).unit("s").optional();
    source.in("commands", PLR_MESSAGE_VALUES, PLR_PORT_OPTIONAL);
    source.out("scans", PLR_MESSAGE_SCAN).out("truth", PLR_MESSAGE_TRUTH);
    FakePlugin& tracker = plugins.add("tracker.fake", "tracker");
    tracker.parameter("threshold", PLR_TYPE_DOUBLE).unit("m").initially("10 m").min(0);
    tracker.slot("estimator", "estimator", 1, 1).slot("second", "estimator", 0, 1);
    tracker.in("scans", PLR_MESSAGE_SCAN, PLR_PORT_MANY).in("hints", PLR_MESSAGE_TRACKS, PLR_PORT_OPTIONAL);
    tracker.out("tracks", PLR_MESSAGE_TRACKS).out("commands", PLR_MESSAGE_VALUES);
    FakePlugin& analyzer = plugins.add("analyzer.fake", "analyzer");
    analyzer.in("tracks", PLR_MESSAGE_TRACKS).in("truth", PLR_MESSAGE_TRUTH, PLR_PORT_OPTIONAL);
    analyzer.out("report", PLR_MESSAGE_TABLE);
}

std::string pipeline() {
    return R"(pelorus: 1
title: a test
run: {seed: 7}
graph:
  world:
    use: source.fake
    with: {scans: 100}
    parts:
      sensors:
        radar: {use: sensor.fake, with: {noise: 2 m, detection_probability: 90 %}}
  tracker:
    use: tracker.fake
    in: {scans: world.scans}
    parts:
      estimator:
        use: estimator.fake
        parts:
          motion: {use: motion.fake, with: {form: truncated}}
          sensors: {radar: {like: world.sensors.radar}}
  errors:
    use: analyzer.fake
    in: {tracks: tracker.tracks, truth: world.truth}
)";
}

}  // namespace pelorus::fakes
