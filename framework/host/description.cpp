#include "host/description.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <string_view>

#include "host/first_size.hpp"
#include "host/kinds.hpp"
#include "host/plugin_error.hpp"

namespace pelorus::host {

namespace {

// Longer texts are taken for garbage: nothing that a plugin says in one breath is that long.
constexpr std::size_t longest_text = 1u << 16;

struct Wrong : std::runtime_error {
    using std::runtime_error::runtime_error;
};

void need(bool good, const std::string& otherwise) {
    if (!good) throw Wrong(otherwise);
}

void need_text(const char* text, const std::string& where, const char* what) {
    need(text != nullptr, where + " has no " + what + " (NULL)");
}

/// Names are parts of addresses (`world.sensors.radar.noise`): words of letters, digits, _ and -.
std::string need_name(const char* text, const std::string& where) {
    need(text != nullptr && *text != '\0', where + " has no name");
    const std::string name = one_line(text, longest_text);
    for (const char character : name) {
        const bool is_letter = (character >= 'a' && character <= 'z') || (character >= 'A' && character <= 'Z');
        const bool is_digit = character >= '0' && character <= '9';
        need(is_letter || is_digit || character == '_' || character == '-',
             where + " is called \"" + name + "\": a name is made of letters, digits, _ and -");
    }
    return name;
}

/// What shares one level of addresses must have different names.
class Names {
public:
    void add(const std::string& name, const std::string& what) {
        for (const char* word : {"use", "with", "parts", "in", "like", "frame"})
            need(name != word, what + " is called " + name + ", which is a word of the config itself");
        need(names_.insert(name).second, what + ": its name is taken");
    }

private:
    std::set<std::string> names_;
};

/// The array behind a count: there, and of structs that this host can read.
template <class Element> void need_array(const Element* first, std::uint32_t count, const std::string& what) {
    if (count == 0) return;
    need(first != nullptr, "it claims " + std::to_string(count) + " " + what + " but gives none (NULL)");
    need(first->struct_size >= first_size<Element>, what + ": a struct_size of " + std::to_string(first->struct_size) +
                                                        " bytes, expected at least " +
                                                        std::to_string(first_size<Element>));
}

void check_choices(const plr_parameter& parameter, const std::string& where) {
    need(parameter.choice_count > 0 && parameter.choices != nullptr, where + " is a choice of nothing");
    std::set<std::string_view> words;
    for (std::uint32_t i = 0; i < parameter.choice_count; ++i) {
        const char* word = parameter.choices[i];
        need(word != nullptr && *word != '\0', where + " has a choice without a word");
        need(words.insert(word).second, where + " offers the choice " + one_line(word, longest_text) + " twice");
    }
}

void check_sizes(const plr_parameter& parameter, const std::string& where) {
    const auto is_range = [](std::int32_t low, std::int32_t high) { return low >= 0 && (high == -1 || high >= low); };
    const bool has_rows =
        parameter.type == PLR_TYPE_VECTOR || parameter.type == PLR_TYPE_MATRIX || parameter.type == PLR_TYPE_TABLE;
    if (has_rows)
        need(is_range(parameter.rows_min, parameter.rows_max),
             where + " has rows_min and rows_max that no value satisfies");
    if (parameter.type == PLR_TYPE_MATRIX)
        need(is_range(parameter.cols_min, parameter.cols_max),
             where + " has cols_min and cols_max that no value satisfies");
}

enum class Place { plugin, slot, column };

/// A parameter or a column, apart from the columns that it may have itself.
void check_value(const plr_parameter& parameter, const std::string& where, Place place) {
    need_text(parameter.doc, where, "doc");
    need_text(parameter.unit, where, "unit (\"\" for pure numbers)");
    need(parameter.type >= PLR_TYPE_BOOL && parameter.type <= PLR_TYPE_TABLE,
         where + " has the unknown type " + std::to_string(parameter.type));
    need(!std::isnan(parameter.min) && !std::isnan(parameter.max) && parameter.min <= parameter.max,
         where + " has min and max that no value satisfies");
    if (parameter.type == PLR_TYPE_CHOICE) check_choices(parameter, where);
    check_sizes(parameter, where);
    const bool required = (parameter.flags & PLR_PARAMETER_REQUIRED) != 0;
    const bool optional = (parameter.flags & PLR_PARAMETER_OPTIONAL) != 0;
    need(!required || !optional, where + " is both required and optional");
    // A column without a default is simply one that every row has.
    if (!required && !optional && place != Place::column)
        need(parameter.default_text != nullptr, where + " has no default, and is neither required nor optional");
}

void check_parameters(const plr_parameter* parameters, std::uint32_t count, const std::string& holder, Place place,
                      Names& names) {
    const std::string what = place == Place::column ? "column" : "parameter";
    need_array(parameters, count, what + "s" + holder);
    for (std::uint32_t i = 0; i < count; ++i) {
        const plr_parameter& parameter = element(parameters, i);
        const std::string name = need_name(parameter.name, what + " " + std::to_string(i) + holder);
        const std::string where = what + " " + name + holder;
        names.add(name, where);
        check_value(parameter, where, place);
        if (parameter.type != PLR_TYPE_TABLE) {
            if (place == Place::column)
                need(parameter.type <= PLR_TYPE_CHOICE, where + " is neither bool, int, double, string nor choice");
            continue;
        }
        need(place != Place::column, where + " is a table: tables do not nest");
        need(parameter.column_count > 0, where + " is a table without columns");
        Names columns;
        check_parameters(parameter.columns, parameter.column_count, " of " + where, Place::column, columns);
    }
}

void check_inputs(const plr_description& description) {
    need_array(description.inputs, description.input_count, "inputs");
    std::set<std::string> names;
    for (std::uint32_t i = 0; i < description.input_count; ++i) {
        const plr_input& input = element(description.inputs, i);
        const std::string name = need_name(input.name, "input " + std::to_string(i));
        const std::string where = "input " + name;
        need(names.insert(name).second, where + ": its name is taken");
        need_text(input.unit, where, "unit (\"\" for pure numbers)");
        need_text(input.doc, where, "doc");
        need(input.size > 0 && input.defaults != nullptr, where + " has no size or no defaults");
    }
}

void check_slots(const plr_description& description, Names& names) {
    need_array(description.slots, description.slot_count, "slots");
    for (std::uint32_t i = 0; i < description.slot_count; ++i) {
        const plr_slot& slot = element(description.slots, i);
        const std::string name = need_name(slot.name, "slot " + std::to_string(i));
        const std::string where = "slot " + name;
        names.add(name, where);
        need_text(slot.doc, where, "doc");
        need_text(slot.kind, where, "kind");
        need(find_kind(slot.kind) != nullptr,
             where + " is for plugins of the unknown kind " + one_line(slot.kind, longest_text));
        need(
            slot.min >= 0 && (slot.max == -1 || slot.max >= (slot.min > 1 ? slot.min : 1)),
            where + " holds " + std::to_string(slot.min) + " to " + std::to_string(slot.max) + " parts, which is none");
        Names of_part;
        check_parameters(slot.parameters, slot.parameter_count, " of " + where, Place::slot, of_part);
    }
}

void check_ports(const plr_port* ports, std::uint32_t count, const std::string& direction) {
    need_array(ports, count, direction + " ports");
    std::set<std::string> names;
    for (std::uint32_t i = 0; i < count; ++i) {
        const plr_port& port = element(ports, i);
        const std::string name = need_name(port.name, direction + " port " + std::to_string(i));
        const std::string where = direction + " port " + name;
        need(names.insert(name).second, where + ": its name is taken");
        need_text(port.doc, where, "doc");
        need(port.message >= PLR_MESSAGE_SCAN && port.message <= PLR_MESSAGE_TABLE,
             where + " carries messages of the unknown kind " + std::to_string(port.message));
    }
}

void check(const plr_description& description) {
    need(description.struct_size >= first_size<plr_description>,
         "a struct_size of " + std::to_string(description.struct_size) + " bytes, expected at least " +
             std::to_string(first_size<plr_description>));
    const std::pair<const char*, const char*> texts[] = {
        {description.id, "id"},         {description.kind, "kind"},       {description.version, "version"},
        {description.title, "title"},   {description.purpose, "purpose"}, {description.equation, "equation"},
        {description.source, "source"}, {description.license, "license"},
    };
    for (const auto& [text, what] : texts) need_text(text, "it", what);
    const Kind* kind = find_kind(description.kind);
    need(kind != nullptr, "the unknown kind " + one_line(description.kind, longest_text));
    Names names;  // parameters and slots are both addressed as NODE.NAME
    check_parameters(description.parameters, description.parameter_count, "", Place::plugin, names);
    check_slots(description, names);
    check_inputs(description);
    need(kind->is_stage || description.in_port_count + description.out_port_count == 0, "a model has no ports");
    check_ports(description.in_ports, description.in_port_count, "in");
    check_ports(description.out_ports, description.out_port_count, "out");
}

}  // namespace

std::string description_problem(const plr_description& description) {
    try {
        check(description);
        return {};
    } catch (const Wrong& wrong) {
        return wrong.what();
    }
}

}  // namespace pelorus::host
