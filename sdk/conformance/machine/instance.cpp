#include "instance.hpp"

#include <algorithm>
#include <cstring>

#include "library.hpp"

namespace pelorus::conformance {

namespace {

/// Element `index` of an array whose structs may be longer than we know.
template <class Element> const Element& element(const Element* first, std::uint32_t index) noexcept {
    const auto* at = reinterpret_cast<const unsigned char*>(first);
    return *reinterpret_cast<const Element*>(at + std::uint64_t{index} * first->struct_size);
}

/// An array of structs as a host of a later minor version would have it: each longer at the tail.
template <class Element> class Grown {
public:
    void fill(const std::vector<Element>& elements, std::uint32_t extra) {
        const std::size_t step = (sizeof(Element) + extra + 7) / 8 * 8;
        bytes_.assign(elements.size() * step + 8, 0xA5);
        for (std::size_t i = 0; i < elements.size(); ++i) {
            Element copy = elements[i];
            copy.struct_size = static_cast<std::uint32_t>(step);
            std::memcpy(bytes_.data() + i * step, &copy, sizeof copy);
        }
    }
    const Element* data() const noexcept { return reinterpret_cast<const Element*>(bytes_.data()); }

private:
    std::vector<unsigned char> bytes_;
};

std::uint64_t rounded(std::size_t bytes) noexcept { return (bytes + 7) / 8; }

}  // namespace

CreateFailed::CreateFailed(plr_status status_, const plr_error& error_)
    : std::runtime_error(told(status_, error_)), status(status_), error(error_) {}

struct Instance::Living {
    const plr_plugin* plugin = nullptr;
    std::string address, frame, slot, name;
    std::unique_ptr<Values> values;
    std::unique_ptr<Values> slot_values;
    std::vector<plr_part> parts;
    std::vector<std::string> input_names;
    std::vector<plr_input_place> inputs;
    Grown<plr_value> grown_values, grown_slot_values;
    Grown<plr_part> grown_parts;
    Grown<plr_input_place> grown_inputs;
    std::vector<std::uint64_t> config_memory;  // a plr_config and what a later version may have behind it
    plr_instance instance{};
    std::uint32_t extra = 0;

    plr_config& config() noexcept { return *reinterpret_cast<plr_config*>(config_memory.data()); }
    plr_part as_part() const {
        plr_part part{};
        part.struct_size = sizeof part;
        part.slot = slot.c_str();
        part.name = name.c_str();
        part.address = address.c_str();
        part.table_id = plugin->table_id;
        part.description = plugin->description;
        part.instance = instance;
        if (slot_values) {
            part.value_count = slot_values->size();
            part.values = extra != 0 ? grown_slot_values.data() : slot_values->data();
        }
        return part;
    }
};

namespace {

std::vector<plr_value> copied(const Values& values) { return {values.data(), values.data() + values.size()}; }

std::vector<std::string> parameter_names(const plr_parameter* first, std::uint32_t count) {
    std::vector<std::string> names;
    for (std::uint32_t i = 0; i < count; ++i) names.emplace_back(element(first, i).name);
    return names;
}

/// What stands in a slot: the subject's parts or, in a slot that must not be empty, reference plugins.
std::vector<Node> parts_for(const plr_slot& slot, const Node& node) {
    std::vector<Node> found;
    for (const Node& part : node.parts)
        if (part.slot == slot.name) found.push_back(part);
    while (static_cast<std::int32_t>(found.size()) < slot.min) {
        const plr_plugin* const reference = reference_part(slot.kind);
        if (reference == nullptr)
            throw Refused(std::string("slot ") + slot.name + " wants a part of kind " + slot.kind +
                          "; name one in a file of subjects (--subjects)");
        Node part;
        part.slot = slot.name;
        part.name = slot.max == 1 ? "" : slot.kind + std::to_string(found.size() + 1);
        part.use = reference->description->id;
        found.push_back(part);
    }
    return found;
}

void check_slots(const plr_description& description, const Node& node) {
    for (const Node& part : node.parts) {
        bool known = false;
        for (std::uint32_t s = 0; s < description.slot_count; ++s)
            known = known || part.slot == element(description.slots, s).name;
        if (!known) throw Refused(std::string(description.id) + " has no slot " + part.slot);
    }
}

void check_keys(const Host& host, const Node& node, const plr_description& description, const plr_slot* slot) {
    if (!node.with) return;
    std::vector<std::string> known = parameter_names(description.parameters, description.parameter_count);
    if (slot != nullptr)
        for (const std::string& name : parameter_names(slot->parameters, slot->parameter_count)) known.push_back(name);
    host.check_keys(*node.with, known, description.id);
}

}  // namespace

Instance::Living& Instance::create(const Host& host, const plr_plugin& plugin, const Node& node,
                                   const std::string& address, const Surroundings& surroundings,
                                   std::int64_t& input_offset) {
    const plr_description& description = *plugin.description;
    auto own = std::make_unique<Living>();
    own->plugin = &plugin;
    own->address = address;
    own->frame = node.frame;
    own->slot = node.slot;
    own->name = node.name;
    own->extra = surroundings.extra_struct_bytes;
    own->values = host.values(description.parameters, description.parameter_count, node.with.get(), description.id);
    check_slots(description, node);
    const std::int64_t own_offset = input_offset;
    for (std::uint32_t i = 0; i < description.input_count; ++i) {
        const plr_input& input = element(description.inputs, i);
        own->input_names.emplace_back(input.name);
        own->inputs.push_back({sizeof(plr_input_place), input.size, nullptr, input.unit, input_offset, input.defaults});
        inputs_.insert(inputs_.end(), input.defaults, input.defaults + input.size);
        input_offset += input.size;
    }
    for (std::uint32_t s = 0; s < description.slot_count; ++s) {
        const plr_slot& slot = element(description.slots, s);
        for (const Node& part : parts_for(slot, node)) {
            const plr_plugin* const reference = reference_plugin(part.use);
            const plr_plugin& used = part.use.empty()       ? plugin
                                     : reference != nullptr ? *reference
                                                            : host.plugin(part.use);
            check_keys(host, part, *used.description, &slot);
            const std::string below = part.slot + (part.name.empty() ? "" : "." + part.name);
            Living& made = create(host, used, part, address + "." + below, surroundings, input_offset);
            made.slot_values =
                host.values(slot.parameters, slot.parameter_count, part.with.get(), used.description->id);
            if (made.extra != 0) made.grown_slot_values.fill(copied(*made.slot_values), made.extra);
            own->parts.push_back(made.as_part());
            for (std::size_t i = 0; i < made.inputs.size(); ++i) {
                own->input_names.push_back(below + "." + made.input_names[i]);
                own->inputs.push_back(made.inputs[i]);
            }
        }
    }
    for (std::size_t i = 0; i < own->inputs.size(); ++i) own->inputs[i].name = own->input_names[i].c_str();

    own->config_memory.assign(rounded(sizeof(plr_config) + own->extra) + 1, 0);
    plr_config& config = own->config();
    config.struct_size = static_cast<std::uint32_t>(sizeof config) + own->extra;
    config.address = own->address.c_str();
    config.value_count = own->values->size();
    config.values = own->values->data();
    config.part_count = static_cast<std::uint32_t>(own->parts.size());
    config.parts = own->parts.data();
    config.input_count = static_cast<std::uint32_t>(own->inputs.size());
    config.inputs = own->inputs.data();
    if (own->extra != 0) {
        own->grown_values.fill(copied(*own->values), own->extra);
        own->grown_parts.fill(own->parts, own->extra);
        own->grown_inputs.fill(own->inputs, own->extra);
        config.values = own->grown_values.data();
        config.parts = own->grown_parts.data();
        config.inputs = own->grown_inputs.data();
    }
    config.input_offset = own_offset;
    config.input_size = input_offset;
    config.key = surroundings.key;
    config.frame = own->frame.c_str();
    config.host = services_->host();
    plr_error error = empty_error();
    const plr_status status = plugin.create(&config, &own->instance, &error);
    if (status != PLR_OK) throw CreateFailed(status, error);
    if (own->instance.table == nullptr || own->instance.table->destroy == nullptr)
        throw Refused(std::string(description.id) + ": create answered PLR_OK without a call table");
    living_.push_back(std::move(own));
    return *living_.back();
}

Instance::Instance(const Host& host, const plr_plugin& plugin, const Node& node, const Surroundings& surroundings)
    : own_services_(surroundings.services == nullptr ? std::make_unique<Services>(host) : nullptr),
      services_(surroundings.services == nullptr ? own_services_.get() : surroundings.services) {
    check_keys(host, node, *plugin.description, nullptr);
    std::int64_t input_offset = 0;
    try {
        create(host, plugin, node, "subject", surroundings, input_offset);
    } catch (...) {
        destroy();
        throw;
    }
}

Instance::~Instance() { destroy(); }

void Instance::destroy() {
    while (!living_.empty()) {
        const plr_instance& ending = living_.back()->instance;
        ending.table->destroy(ending.self);
        living_.pop_back();
    }
}

const plr_plugin& Instance::plugin() const noexcept { return *living_.back()->plugin; }
const plr_config& Instance::config() const noexcept { return living_.back()->config(); }
void* Instance::self() const noexcept { return living_.back()->instance.self; }
const plr_table_head& Instance::head() const noexcept { return *living_.back()->instance.table; }

const plr_part* Instance::part(const std::string& slot) const {
    for (const plr_part& part : living_.back()->parts)
        if (slot == part.slot) return &part;
    return nullptr;
}

}  // namespace pelorus::conformance
